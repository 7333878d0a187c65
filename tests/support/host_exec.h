// SPDX-License-Identifier: MIT
// Runs kernels on the host: blocks one after the other, in the order of the moment (host_block.h).
// The counterpart of glint/cuda/device_exec.cuh, for parity tests without a GPU and for sanitizers;
// slow, and no part of the product.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>
#include <vector>

#include "glint/core/device.h"
#include "glint/core/kernel_trace.h"
#include "tests/support/host_block.h"
#include "tests/support/host_memory.h"

namespace glint::test {

class HostExec {
 public:
  template <class T>
  using Buffer = gpu::DeviceBuffer<T, HostDeviceMemory>;

  template <class T>
  void download(const Buffer<T>& from, std::size_t count, T* to) {
    ++device_counters.downloads;
    ++device_counters.waits;
    const OpenMemory open(OpenMemory::kBoth);
    std::copy_n(from.data(), count, to);
  }
  template <class T>
  void fill_zero(Buffer<T>& buffer) {
    const OpenMemory open(OpenMemory::kDevice);
    std::fill_n(buffer.data(), buffer.size(), T{});
  }
  template <class F>
  void for_each(std::size_t count, F f) {
    ++device_counters.launches;
    const OpenMemory open(OpenMemory::kDevice);
    const TracedKernel traced(typeid(F));
    in_host_order(count, f);
  }
  template <class Body>
  void launch(std::size_t blocks, const Body& body) {
    ++device_counters.launches;
    const OpenMemory open(OpenMemory::kDevice);
    const TracedKernel traced(typeid(Body));
    in_host_order(blocks, [&](std::size_t i) { run_block(body, static_cast<int>(i)); });
  }
  // sums[i] = counts[0] + ... + counts[i - 1] for i in [0, count], added by `add`.
  template <class T, class Add = gpu::Plus>
  void exclusive_sum_on_device(
      const Buffer<T>& counts, std::size_t count, Buffer<T>& sums, Add add = {}
  ) {
    sums.resize(count + 1);
    ++device_counters.launches;
    const OpenMemory open(OpenMemory::kDevice);
    sums.data()[0] = T{};
    std::partial_sum(counts.data(), counts.data() + count, sums.data() + 1, add);
  }
  // Stable, by the low `bits` bits of the keys.
  template <class Key>
  void sort_pairs(std::size_t count, int bits, Buffer<Key>& keys, Buffer<std::uint32_t>& values) {
    ++device_counters.launches;
    const OpenMemory open(OpenMemory::kBoth);
    sort_now(count, bits, keys.data(), values.data());
  }

 private:
  template <class Body>
  static void run_block(const Body& body, int index) {
    HostBlock<Body::kThreads> block;
    block.index = index;
    const auto shared = std::make_unique<typename Body::Shared>();
    body(block, *shared);
  }
  template <class Key>
  static void sort_now(std::size_t count, int bits, Key* keys, std::uint32_t* values) {
    constexpr int kBits = 8 * sizeof(Key);
    const Key mask =
        bits < kBits ? static_cast<Key>((Key{1} << bits) - 1) : static_cast<Key>(~Key{0});
    std::vector<std::pair<Key, std::uint32_t>> pairs(count);
    for (std::size_t i = 0; i < count; ++i) pairs[i] = {keys[i], values[i]};
    std::stable_sort(pairs.begin(), pairs.end(), [&](const auto& a, const auto& b) {
      return (a.first & mask) < (b.first & mask);
    });
    for (std::size_t i = 0; i < count; ++i) {
      keys[i] = pairs[i].first;
      values[i] = pairs[i].second;
    }
  }
};

}  // namespace glint::test
