// SPDX-License-Identifier: MIT
// The tree of the GPU's tracer, built by its kernels on the host.
#include "glint/cuda/trace_tree.h"

#include "tests/glint/cuda/trace_parity.h"

using namespace glint;
using namespace glint::test;
using namespace glint::gpu;

namespace {

constexpr TraceCutoffs kCutoffs{0, kMaxRho, kMinAlpha, kMinTransmittance, 256};

bool holds(const Box& outer, const Box& inner) {
  for (int axis = 0; axis < 3; ++axis)
    if (inner.low[axis] < outer.low[axis] || inner.high[axis] > outer.high[axis]) return false;
  return true;
}

// How often each slot is found below a node; each disc's box lies in those of all nodes above it.
void visit(const Tree& tree, std::uint32_t index, const Box& bounds, std::vector<int>& found) {
  const WideNode& node = tree.wide[index];
  for (int k = 0; k < kWidth; ++k) {
    Box box;
    for (int axis = 0; axis < 3; ++axis)
      box.low[axis] = node.low[axis][k], box.high[axis] = node.high[axis][k];
    if (box.low.x > box.high.x) continue;  // empty
    CHECK(holds(bounds, box));
    const ChildRef child = node.children[k];
    if (!child.is_leaf()) {
      visit(tree, child.node(), box, found);
      continue;
    }
    for (std::uint32_t slot = child.first(); slot < child.first() + child.count(); ++slot) {
      ++found[slot];
      if (tree.discs[slot].max_rho > 0) CHECK(holds(box, box_of(tree.discs[slot])));
    }
  }
}

// Whether rays can find each surfel that counts, once.
void check_tree(const TraceArrays& arrays) {
  HostExec exec;
  TraceTree<HostExec> owner(exec);
  owner.update(device_input(arrays.view()), kCutoffs, {});
  const Tree tree = owner.tree();
  const OpenMemory open(OpenMemory::kBoth);
  const std::size_t n = arrays.surfels.count();
  std::vector<int> found(n), owners(n);
  constexpr float kAll = 1e30f;
  visit(tree, 0, {{-kAll, -kAll, -kAll}, {kAll, kAll, kAll}}, found);
  for (std::size_t slot = 0; slot < n; ++slot) {
    const Disc& disc = tree.discs[slot];
    CHECK(tree.slot_of[disc.surfel] == slot);
    ++owners[disc.surfel];
    CHECK(found[slot] <= 1);
    if (disc.max_rho > 0) CHECK(found[slot] == 1);
  }
  CHECK(std::all_of(owners.begin(), owners.end(), [](int count) { return count == 1; }));
}

}  // namespace

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
  owner.update(device_input(arrays.view()), kCutoffs, {});
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
