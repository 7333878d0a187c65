// SPDX-License-Identifier: MIT
// A block of threads and its warps (glint/cuda/block.h) on the host: the threads one after the
// other within each phase, in an order that tests choose, so that what depends on it shows.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "glint/cuda/block.h"

namespace glint::test {

// Of all loops of the host's kernels; 0: ascending. Others: as good as any order of a GPU.
inline std::uint64_t host_order = 0;
class HostOrder {
 public:
  explicit HostOrder(std::uint64_t order) : before_(std::exchange(host_order, order)) {}
  ~HostOrder() { host_order = before_; }
  HostOrder(const HostOrder&) = delete;
  HostOrder& operator=(const HostOrder&) = delete;

 private:
  std::uint64_t before_;
};

// f(i) for every i in [0, count), in the order of the moment: i = first + k step modulo the count,
// with a step that shares no divisor with it.
template <class F>
void in_host_order(std::size_t count, F&& f) {
  if (host_order == 0 || count < 2) {
    for (std::size_t i = 0; i < count; ++i) f(i);
    return;
  }
  std::size_t step = 0x9e3779b97f4a7c15u * host_order % count;
  while (std::gcd(step, count) != 1) ++step;
  std::size_t i = host_order * 7919 % count;
  for (std::size_t k = 0; k < count; ++k, i = (i + step) % count) f(i);
}

class HostWarp {
 public:
  template <class T>
  struct PerLane {
    std::array<T, gpu::kWarp> values{};
    T& operator[](int lane) { return values[static_cast<std::size_t>(lane)]; }
  };
  int index;

  explicit HostWarp(int i) : index(i) {}
  int thread(int lane) const { return index * gpu::kWarp + lane; }
  template <class F>
  void each(F&& f) {
    in_host_order(gpu::kWarp, [&](std::size_t lane) { f(static_cast<int>(lane)); });
  }
  template <class F>
  std::uint32_t ballot(F&& f) {
    std::uint32_t bits = 0;
    each([&](int lane) { bits |= static_cast<std::uint32_t>(f(lane)) << lane; });
    return bits;
  }
  template <class T>
  T broadcast(PerLane<T>& v, int from) {
    return v[from];
  }
  template <class T>
  void match(PerLane<T>& v, PerLane<std::uint32_t>& masks) {
    for (int lane = 0; lane < gpu::kWarp; ++lane)
      masks[lane] = ballot([&](int other) { return v[other] == v[lane]; });
  }
  float sum(PerLane<float>& v) {
    for (int bit = 1; bit < gpu::kWarp; bit *= 2) {
      const PerLane<float> before = v;
      each([&](int lane) { v[lane] += before.values[static_cast<std::size_t>(lane ^ bit)]; });
    }
    return v[0];
  }
  template <int kN>
  void sums(
      PerLane<gpu::Row<kN>>& v, PerLane<gpu::Row<(kN + gpu::kWarp - 1) / gpu::kWarp>>& totals
  ) {
    for (int first = 0; first < kN; first += gpu::kWarp) {
      int count = std::min(gpu::kWarp, kN - first);
      for (int bit = 1; bit < gpu::kWarp; bit *= 2, count = (count + 1) / 2)
        halve(v, first, count, bit);
      for (int lane = 0; lane < gpu::kWarp; ++lane)
        totals[lane].v[first / gpu::kWarp] = v[lane].v[first];
    }
  }

 private:
  template <int kN>
  static void halve(PerLane<gpu::Row<kN>>& v, int first, int count, int bit) {
    PerLane<gpu::Row<kN>> before = v;
    for (int lane = 0; lane < gpu::kWarp; ++lane)
      for (int i = 0; i < (count + 1) / 2; ++i) {
        const auto half = [&](int of) {
          return gpu::half_of(before[of].v + first, count, (lane & bit) != 0, i);
        };
        v[lane].v[first + i] = half(lane) + half(lane ^ bit);
      }
  }
};

template <int kThreads>
class HostBlock {
 public:
  static_assert(kThreads % gpu::kWarp == 0);
  template <class T>
  struct PerThread {
    std::vector<T> values = std::vector<T>(kThreads);
    T& operator[](int thread) { return values[static_cast<std::size_t>(thread)]; }
  };
  int index = 0;

  template <class F>
  void each(F&& f) {
    in_host_order(kThreads, [&](std::size_t thread) { f(static_cast<int>(thread)); });
  }
  template <class F>
  bool any(F&& f) {
    bool result = false;
    each([&](int thread) { result |= f(thread); });
    return result;
  }
  template <class F>
  void each_warp(F&& f) {
    in_host_order(kThreads / gpu::kWarp, [&](std::size_t i) {
      HostWarp warp(static_cast<int>(i));
      f(warp);
    });
  }
  void add(float* p, float value) { *p += value; }
};

}  // namespace glint::test
