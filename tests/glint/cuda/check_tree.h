// SPDX-License-Identifier: MIT
// What must hold of the tree of the GPU's tracer, built by its kernels on the host.
#pragma once

#include <catch2/catch.hpp>

#include "glint/cuda/ops.h"
#include "tests/support/host_exec.h"
#include "tests/support/trace_arrays.h"

namespace glint::test {

inline constexpr gpu::TraceCutoffs kTreeCutoffs{0, kMaxRho, kMinAlpha, kMinTransmittance, 256};

// What is found below the root.
struct TreeVisit {
  const gpu::Tree& tree;
  std::vector<int> found;        // how often, of each slot
  std::size_t sticking_out = 0;  // boxes and discs that leave the box of a node above them

  // bounds: of the node.
  void visit(std::uint32_t index, const gpu::Box& bounds) {
    const gpu::WideNode& node = tree.wide[index];
    for (int k = 0; k < gpu::kWidth; ++k) {
      gpu::Box box;
      for (int axis = 0; axis < 3; ++axis)
        box.low[axis] = node.low[axis][k], box.high[axis] = node.high[axis][k];
      if (box.low.x > box.high.x) continue;  // empty
      sticking_out += !holds(bounds, box);
      visit(node.children[k], box);
    }
  }

 private:
  void visit(gpu::ChildRef child, const gpu::Box& box) {
    if (!child.is_leaf()) return visit(child.node(), box);
    for (std::uint32_t slot = child.first(); slot < child.first() + child.count(); ++slot) {
      ++found[slot];
      const gpu::Disc& disc = tree.discs[slot];
      if (disc.max_rho > 0) sticking_out += !holds(box, box_of(disc));
    }
  }
  static bool holds(const gpu::Box& outer, const gpu::Box& inner) {
    for (int axis = 0; axis < 3; ++axis)
      if (!(inner.low[axis] >= outer.low[axis] && inner.high[axis] <= outer.high[axis]))
        return false;
    return true;
  }
};

// Whether rays can find each surfel that counts, once.
inline void check_tree(const TraceInput& input) {
  HostExec exec;
  gpu::TraceTree<HostExec> owner(exec);
  owner.update(gpu::device_input(input), kTreeCutoffs, {});
  const gpu::Tree tree = owner.tree();
  const OpenMemory open(OpenMemory::kBoth);
  TreeVisit all{tree, std::vector<int>(input.count)};
  constexpr float kAll = 1e30f;
  all.visit(0, {{-kAll, -kAll, -kAll}, {kAll, kAll, kAll}});
  CHECK(all.sticking_out == 0);
  std::vector<int> owners(input.count);
  std::size_t misplaced = 0, repeated = 0, lost = 0;
  for (std::size_t slot = 0; slot < input.count; ++slot) {
    const gpu::Disc& disc = tree.discs[slot];
    misplaced += tree.slot_of[disc.surfel] != slot;
    ++owners[disc.surfel];
    repeated += all.found[slot] > 1;
    lost += disc.max_rho > 0 && all.found[slot] == 0;
  }
  CHECK(misplaced == 0);
  CHECK(repeated == 0);
  CHECK(lost == 0);
  CHECK(std::all_of(owners.begin(), owners.end(), [](int count) { return count == 1; }));
}
inline void check_tree(const TraceArrays& arrays) { check_tree(arrays.view()); }

}  // namespace glint::test
