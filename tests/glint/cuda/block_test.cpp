// SPDX-License-Identifier: MIT
// Warps (glint/cuda/block.h) as kernels see them, in several orders of the host's threads.
#include "glint/cuda/block.h"

#include <catch2/catch.hpp>
#include <numeric>
#include <set>

#include "glint/core/rng.h"
#include "tests/support/host_exec.h"

using namespace glint;
using namespace glint::test;
using gpu::kWarp;

namespace {

constexpr int kBlockSize = 96;

// Each thread's number of `in`, [blocks][kBlockSize]: what warps make of it.
struct AskWarps {
  static constexpr int kThreads = kBlockSize;
  struct Shared {
    int values[kThreads];
  };
  const int* in;
  std::uint32_t *odd, *same;  // per warp; per thread
  int *third, *next;          // per thread: of lane 3; of the next lane
  float* sum;                 // per warp

  template <class Block>
  void operator()(Block& block, Shared& shared) const {
    typename Block::template PerThread<int> values;
    const int first = block.index * kThreads;
    block.each([&](int thread) { values[thread] = in[first + thread]; });
    block.each_warp([&](auto& warp) {
      using Warp = std::remove_reference_t<decltype(warp)>;
      typename Warp::template PerLane<int> mine;
      typename Warp::template PerLane<std::uint32_t> masks;
      typename Warp::template PerLane<float> floats;
      warp.each([&](int lane) {
        mine[lane] = shared.values[warp.thread(lane)] = values[warp.thread(lane)];
        floats[lane] = static_cast<float>(mine[lane]);
      });
      const int w = block.index * (kThreads / kWarp) + warp.index;
      odd[w] = warp.ballot([&](int lane) { return mine[lane] % 2 != 0; });
      sum[w] = warp.sum(floats);
      const int of_third = warp.broadcast(mine, 3);
      warp.match(mine, masks);
      warp.each([&](int lane) {
        const int i = first + warp.thread(lane);
        third[i] = of_third;
        same[i] = masks[lane];
        next[i] = shared.values[warp.index * kWarp + (lane + 1) % kWarp];
      });
    });
  }
};

template <int kN>
void check_sums() {
  CAPTURE(kN);
  constexpr int kGroups = (kN + kWarp - 1) / kWarp;
  HostWarp warp(0);
  HostWarp::PerLane<gpu::Row<kN>> v;
  HostWarp::PerLane<gpu::Row<kGroups>> totals;
  for (int lane = 0; lane < kWarp; ++lane)
    for (int i = 0; i < kN; ++i) v[lane].v[i] = static_cast<float>(lane * i + 7 * i - lane);
  warp.sums<kN>(v, totals);
  for (int i = 0; i < kGroups * kWarp; ++i) {
    const int expected = i < kN ? 31 * 16 * (i - 1) + 32 * 7 * i : 0;
    CHECK(totals[i % kWarp].v[i / kWarp] == static_cast<float>(expected));
  }
}

}  // namespace

TEST_CASE("Warps vote, broadcast, match and sum in any order of the threads") {
  constexpr int kBlocks = 3, kWarps = kBlocks * kBlockSize / kWarp;
  Rng rng(5);
  std::vector<int> in(kBlocks * kBlockSize);
  for (int& v : in) v = static_cast<int>(rng.uniform(0, 9));
  for (const std::uint64_t order : {0, 1, 2, 3}) {
    const HostOrder in_order(order);
    std::vector<std::uint32_t> odd(kWarps), same(in.size());
    std::vector<int> third(in.size()), next(in.size());
    std::vector<float> sum(kWarps);
    HostExec().launch(
        kBlocks, AskWarps{in.data(), odd.data(), same.data(), third.data(), next.data(), sum.data()}
    );
    for (std::size_t i = 0; i < in.size(); ++i) {
      const std::size_t w = i / kWarp, lane = i % kWarp, first = w * kWarp;
      CHECK((odd[w] >> lane & 1) == static_cast<std::uint32_t>(in[i] % 2));
      for (std::size_t other = 0; other < kWarp; ++other)
        CHECK((same[i] >> other & 1) == (in[first + other] == in[i] ? 1u : 0u));
      CHECK(third[i] == in[first + 3]);
      CHECK(next[i] == in[first + (lane + 1) % kWarp]);
      CHECK(sum[w] == static_cast<float>(std::accumulate(&in[first], &in[first] + kWarp, 0)));
    }
  }
}

TEST_CASE("Transposed sums leave sum i with lane i") {
  check_sums<1>();
  check_sums<20>();
  check_sums<23>();
  check_sums<31>();
  check_sums<32>();
  check_sums<40>();
}

TEST_CASE("Orders of the host's loops are permutations, and differ") {
  for (const std::size_t count : {1u, 2u, 6u, 32u, 256u, 1000u}) {
    std::set<std::vector<std::size_t>> orders;
    for (const std::uint64_t order : {0, 1, 2, 3}) {
      const HostOrder in_order(order);
      std::vector<std::size_t> seen;
      in_host_order(count, [&](std::size_t i) { seen.push_back(i); });
      orders.insert(seen);
      std::sort(seen.begin(), seen.end());
      for (std::size_t i = 0; i < count; ++i) CHECK(seen[i] == i);
      CHECK(seen.size() == count);
    }
    if (count >= 32) CHECK(orders.size() == 4);
  }
}
