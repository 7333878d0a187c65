// SPDX-License-Identifier: MIT
// The tree of the GPU's tracer, built by its kernels on the host.
#include "glint/cuda/trace_tree.h"

#include "tests/glint/cuda/check_tree.h"
#include "tests/glint/cuda/trace_parity.h"

using namespace glint;
using namespace glint::test;
using namespace glint::gpu;

TEST_CASE("Rays can find every surfel that counts, once") {
  Rng rng(21);
  for (const std::size_t count : {1, 2, 3, 4, 5, 9, 100, 3000}) {
    CAPTURE(count);
    check_tree(random_arrays(count, rng));
  }
  RoomScene room(500);
  room.add_dead(200);
  room.add_large(20);
  room.add_outlier();
  check_tree(room.arrays);
  TraceArrays same_place;
  for (int i = 0; i < 1000; ++i) same_place.add({1, 2, 3}, {1, 1}, {1, 0, 0, 0}, 0.5, rng);
  check_tree(same_place);
  TraceArrays dead;
  for (int i = 0; i < 10; ++i) dead.add({1, 2, 3}, {1, 1}, {1, 0, 0, 0}, 0, rng);
  check_tree(dead);
}

TEST_CASE("Surfels that come to count after the tree was built are found, those that cease are not"
) {
  Rng rng(22);
  TraceArrays arrays = random_arrays(200, rng);
  for (std::size_t i = 0; i < 40; ++i) arrays.surfels.opacities[i] = 0;
  const Rays rays = random_rays(kParitySize, rng);
  HostExec exec;
  TracePipeline<HostExec> pipeline(exec);
  check_as_on_cpu(pipeline, {arrays.view(), rays, {}});
  for (std::size_t i = 0; i < 60; ++i) arrays.surfels.opacities[i] = i < 20 ? 0.9f : 0;
  check_as_on_cpu(pipeline, {arrays.view(), rays, {}});
}

TEST_CASE("A walk whose stack is full finds the same hits") {
  Rng rng(23);
  const TraceArrays arrays = random_arrays(500, rng);
  const Rays rays = random_rays({8, 8}, rng);
  HostExec exec;
  TraceTree<HostExec> owner(exec);
  owner.update(device_input(arrays.view()), kTreeCutoffs, {});
  const Tree tree = owner.tree();
  const OpenMemory open(OpenMemory::kBoth);
  using List = NearestList<16>;
  using Short = WalkStack<1, 2>;
  using Long = WalkStack<1>;
  const auto stack = std::make_unique<Long>();
  std::uint32_t tested_short = 0, tested_long = 0;
  for (std::size_t i = 3; i < 64; ++i) {
    const WalkedRay ray(
        DeviceRays::at(rays.origins.data(), i), DeviceRays::at(rays.directions.data(), i)
    );
    const auto hits = [&](auto& memory, std::uint32_t& tested) {
      WalkCounts counts;
      TreeWalk<List, std::decay_t<decltype(memory)>, WalkCounts> walk(tree, ray, memory, 0, counts);
      List list(0);
      list.start();
      walk.nearest(list);
      std::vector<std::uint32_t> surfels;
      list.give([&](std::uint32_t surfel) {
        surfels.push_back(surfel);
        return true;
      });
      tested += counts.discs;
      return surfels;
    };
    Short small;
    CHECK(hits(small, tested_short) == hits(*stack, tested_long));
  }
  CHECK(tested_short > tested_long);  // it was full
}

TEST_CASE("A surfel far away costs the rays elsewhere next to nothing") {
  RoomScene room(5000);
  const Rays rays = room_rays({32, 18});
  const MeanCounts before = mean_counts(room.arrays.view(), rays);
  room.add_outlier();
  const MeanCounts after = mean_counts(room.arrays.view(), rays);
  CHECK(after.hits == before.hits);
  CHECK(after.nodes < 1.15 * before.nodes);
  CHECK(after.discs < 1.15 * before.discs);
}

TEST_CASE("Places on the Z-order curve follow from the bits of their cells") {
  constexpr Vec3f kLow{-1, -1, -1}, kHigh{1, 1, 1};
  CHECK(morton_code(kLow, kLow, kHigh) == 0);
  CHECK(morton_code(kHigh, kLow, kHigh) == (std::uint64_t{1} << 63) - 1);
  const float cell = 2.0f / (1 << kMortonBits);
  CHECK(morton_code({-1 + 1.5f * cell, -1, -1}, kLow, kHigh) == 1);
  CHECK(morton_code({-1, -1 + 2.5f * cell, -1}, kLow, kHigh) == 16);
  CHECK(morton_code({0, -1, 0}, kLow, kHigh) == std::uint64_t{5} << 60);
  // Cells are cubes.
  CHECK(
      morton_code({0, 0.5, 0}, {-1, 0, 0}, {1, 1, 1}) ==
      (std::uint64_t{1} << 60 | std::uint64_t{1} << 58)
  );
}
