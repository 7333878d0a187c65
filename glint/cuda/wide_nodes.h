// SPDX-License-Identifier: MIT
// The tree that rays walk: nodes with the boxes of up to kWidth children in one piece of memory;
// leaves are runs of up to kLeafDiscs discs.
#pragma once

#include "glint/core/unrolled.h"
#include "glint/cuda/bvh_bodies.h"

namespace glint::gpu {

inline constexpr int kWidth = 4;
inline constexpr std::uint32_t kLeafDiscs = 2;

// A child: an inner node's number, or a leaf's first slot and its number of discs.
struct ChildRef {
  std::uint32_t bits;

  GLINT_HD static ChildRef none() { return {~0u}; }
  GLINT_HD static ChildRef inner(std::uint32_t node) { return {node}; }
  GLINT_HD static ChildRef leaf(std::uint32_t first, std::uint32_t count) {
    return {kLeaf | (count - 1) << kCountShift | first};
  }
  GLINT_HD bool is_leaf() const { return (bits & kLeaf) != 0; }
  GLINT_HD std::uint32_t node() const { return bits; }
  GLINT_HD std::uint32_t first() const { return bits & kFirstMask; }
  GLINT_HD std::uint32_t count() const { return (bits >> kCountShift & 7u) + 1; }

 private:
  static constexpr std::uint32_t kLeaf = 1u << 31;
  static constexpr int kCountShift = 28;
  static constexpr std::uint32_t kFirstMask = (1u << kCountShift) - 1;
};
static_assert(kLeafDiscs <= 8);

// A line of a GPU's cache. Boxes that are not there are empty.
struct alignas(32 * kWidth) WideNode {
  float low[3][kWidth], high[3][kWidth];
  ChildRef children[kWidth];
};
static_assert(sizeof(WideNode) == 128);

// Every inner node of the binary tree makes the wide node that it would be: of its children, the
// one with the largest surface is replaced by its own two until kWidth are there. Those that
// no other refers to are never looked at.
struct MakeWideNodes {
  const TreeNode* nodes;
  std::size_t count;  // of leaves
  WideNode* wide;

  GLINT_HD void operator()(std::size_t i) const {
    if (i > 0 && nodes[i].count <= kLeafDiscs) return;
    std::uint32_t children[kWidth] = {};
    float areas[kWidth] = {};  // of those that can be opened
    int size = 0;
    const auto put = [&](int place, std::uint32_t node) {
      const float area = nodes[node].count > kLeafDiscs ? half_area(nodes[node].box) : -1.0f;
      unrolled<kWidth>([&](int k) {
        if (k == place) children[k] = node, areas[k] = area;
      });
    };
    if (count == 1)
      put(size++, 0);
    else
      put(size++, nodes[i].left), put(size++, nodes[i].right);
    while (size < kWidth) {
      int best = -1;
      float most = 0;
      std::uint32_t opened = 0;
      unrolled<kWidth>([&](int k) {
        if (k < size && areas[k] > most) best = k, most = areas[k], opened = children[k];
      });
      if (best < 0) break;
      put(best, nodes[opened].left);
      put(size++, nodes[opened].right);
    }
    WideNode& to = wide[i];
    unrolled<kWidth>([&](int k) {
      store(k < size ? &nodes[children[k]] : nullptr, children[k], k, to);
    });
  }

 private:
  GLINT_HD static void store(const TreeNode* node, std::uint32_t index, int k, WideNode& to) {
    const Box box = node != nullptr ? node->box : empty_box();
    for (int axis = 0; axis < 3; ++axis) {
      to.low[axis][k] = box.low[axis];
      to.high[axis][k] = box.high[axis];
    }
    to.children[k] = node == nullptr             ? ChildRef::none()
                     : node->count <= kLeafDiscs ? ChildRef::leaf(node->first, node->count)
                                                 : ChildRef::inner(index);
  }
};

}  // namespace glint::gpu
