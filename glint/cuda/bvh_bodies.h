// SPDX-License-Identifier: MIT
// A binary tree over surfels in Morton order, built and refitted on the device [Karras12:
// "Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees"]. Inner nodes
// 0..n-2, leaves n-1..2n-2; leaf n-1+i is slot i: the i-th surfel of the order. Node 0 is the root.
// Rays walk what wide_nodes.h makes of it.
#pragma once

#include "glint/cuda/trace_discs.h"
#include "glint/render/morton.h"

namespace glint::gpu {

// The union of a block's boxes, to the first.
template <int kThreads, class Block>
GLINT_HD void unite(Block& block, Box* boxes) {
  for (int half = kThreads / 2; half > 0; half /= 2)
    block.each([&](int thread) {
      if (thread < half) boxes[thread] = union_of(boxes[thread], boxes[thread + half]);
    });
}

// Boxes of the centres of runs of surfels, one a block.
struct BoundCenters {
  static constexpr int kThreads = 256;
  struct Shared {
    Box boxes[kThreads];
  };
  DeviceTraceInput input;
  TraceCutoffs cutoffs;
  Box* out;  // [blocks]

  template <class Block>
  GLINT_HD void operator()(Block& block, Shared& shared) const {
    block.each([&](int thread) {
      const std::size_t i =
          static_cast<std::size_t>(block.index) * kThreads + static_cast<std::size_t>(thread);
      shared.boxes[thread] = i < input.count ? center_of(i) : empty_box();
    });
    unite<kThreads>(block, shared.boxes);
    block.each([&](int thread) {
      if (thread == 0) out[block.index] = shared.boxes[0];
    });
  }

 private:
  GLINT_HD Box center_of(std::size_t i) const {
    const Disc disc = disc_at(input, cutoffs, i);
    return disc.max_rho > 0 ? Box{disc.mean, disc.mean} : empty_box();
  }
};
// One box of many, by one block.
struct UniteBoxes {
  static constexpr int kThreads = 256;
  struct Shared {
    Box boxes[kThreads];
  };
  const Box* in;
  std::size_t count;
  Box* out;

  template <class Block>
  GLINT_HD void operator()(Block& block, Shared& shared) const {
    block.each([&](int thread) {
      Box box = empty_box();
      for (std::size_t i = static_cast<std::size_t>(thread); i < count; i += kThreads)
        box = union_of(box, in[i]);
      shared.boxes[thread] = box;
    });
    unite<kThreads>(block, shared.boxes);
    block.each([&](int thread) {
      if (thread == 0) *out = shared.boxes[0];
    });
  }
};

// Subtrees of their own for surfels as large as a good part of the scene, whose boxes would make
// those of all others around them as large; and for those that count nowhere, whose box is empty.
struct MortonKeys {
  DeviceTraceInput input;
  TraceCutoffs cutoffs;
  const Box* bounds;
  std::uint64_t* keys;
  std::uint32_t* order;

  GLINT_HD void operator()(std::size_t i) const {
    order[i] = static_cast<std::uint32_t>(i);
    keys[i] = key(disc_at(input, cutoffs, i));
  }

 private:
  GLINT_HD std::uint64_t key(const Disc& disc) const {
    constexpr float kLarge = 0.1f;  // of the scene: least nodes visited, on made and trained scenes
    constexpr std::uint64_t kNowhere = std::uint64_t{1} << 63, kSmall = std::uint64_t{1} << 62;
    if (!(disc.max_rho > 0)) return kNowhere;
    const float radius2 = disc.max_rho * max_of(length2(disc.h0), length2(disc.h1));
    const bool small = radius2 < square(kLarge * widest(bounds->high - bounds->low));
    return (small ? kSmall : 0) | morton_code(disc.mean, bounds->low, bounds->high) >> 1;
  }
};

// Discs in the order of the tree.
struct PlaceDiscs {
  DeviceTraceInput input;
  TraceCutoffs cutoffs;
  const std::uint32_t* order;
  Disc* discs;             // by slot
  std::uint32_t* slot_of;  // [surfels]

  GLINT_HD void operator()(std::size_t slot) const {
    const std::uint32_t surfel = order[slot];
    discs[slot] = disc_at(input, cutoffs, surfel);
    slot_of[surfel] = static_cast<std::uint32_t>(slot);
  }
};

inline constexpr std::uint32_t kNoParent = ~0u;
struct alignas(16) TreeNode {
  Box box;
  std::uint32_t left, right;  // inner nodes
  std::uint32_t parent;
  std::uint32_t first, count;  // slots below
};

GLINT_HD int leading_zeros(std::uint64_t v) {
#if defined(__CUDA_ARCH__)
  return __clzll(static_cast<long long>(v));
#else
  return v == 0 ? 64 : __builtin_clzll(v);
#endif
}

// Inner node i: the range of keys it covers and where that splits [Karras12 Sec. 4]. Equal keys are
// told apart by their places, as if those were written behind them.
struct BuildNodes {
  const std::uint64_t* keys;
  int count;  // of leaves, at least 2
  TreeNode* nodes;

  GLINT_HD void operator()(std::size_t index) const {
    const int i = static_cast<int>(index);
    const int direction = common(i, i + 1) > common(i, i - 1) ? 1 : -1;
    const int least = common(i, i - direction);
    int most = 2;
    while (common(i, i + most * direction) > least) most *= 2;
    int length = 0;
    for (int step = most / 2; step > 0; step /= 2)
      if (common(i, i + (length + step) * direction) > least) length += step;
    const int other = i + length * direction, shared = common(i, other);
    int split = 0;
    for (int step = (length + 1) / 2, left = length; left > 0; step = (left + 1) / 2) {
      if (common(i, i + (split + step) * direction) > shared) split += step;
      left = step == 1 ? 0 : step;
    }
    link(
        i,
        i + split * direction + (direction < 0 ? -1 : 0),
        i < other ? i : other,
        i < other ? other : i
    );
  }

 private:
  // Length of the common prefix of two keys, -1 outside.
  GLINT_HD int common(int i, int j) const {
    if (j < 0 || j >= count) return -1;
    const int zeros = leading_zeros(keys[i] ^ keys[j]);
    return zeros < 64 ? zeros : 64 + leading_zeros(static_cast<std::uint64_t>(i ^ j));
  }
  GLINT_HD void link(int i, int split, int first, int last) const {
    const auto leaf = [&](int k) { return static_cast<std::uint32_t>(count - 1 + k); };
    TreeNode& node = nodes[i];
    node.left = first == split ? leaf(split) : static_cast<std::uint32_t>(split);
    node.right = last == split + 1 ? leaf(split + 1) : static_cast<std::uint32_t>(split + 1);
    node.first = static_cast<std::uint32_t>(first);
    node.count = static_cast<std::uint32_t>(last - first + 1);
    nodes[node.left].parent = nodes[node.right].parent = static_cast<std::uint32_t>(i);
    if (i == 0) node.parent = kNoParent;
  }
};

// One more; returns how many there were before. Orders what was written before it.
GLINT_HD std::uint32_t count_up(std::uint32_t* counter) {
#if defined(__CUDA_ARCH__)
  __threadfence();
  const std::uint32_t before = atomicAdd(counter, 1u);
  __threadfence();
  return before;
#else
  return (*counter)++;
#endif
}

// From leaf i up: the second child to come makes its parent's box.
struct FitBoxes {
  const Disc* discs;
  std::size_t count;
  TreeNode* nodes;
  std::uint32_t* arrived;  // [inner nodes] zero

  GLINT_HD void operator()(std::size_t i) const {
    auto node = static_cast<std::uint32_t>(count - 1 + i);
    nodes[node].box = box_of(discs[i]);
    nodes[node].first = static_cast<std::uint32_t>(i);
    nodes[node].count = 1;
    while (node != 0 && (node = nodes[node].parent) != kNoParent) {
      if (count_up(&arrived[node]) == 0) return;
      nodes[node].box = union_of(nodes[nodes[node].left].box, nodes[nodes[node].right].box);
    }
  }
};

}  // namespace glint::gpu
