// SPDX-License-Identifier: MIT
// A binary tree over surfels in Morton order, built and refitted on the device [Karras12:
// "Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees"]. Inner nodes
// 0..n-2, leaves n-1..2n-2; leaf n-1+i holds the i-th surfel of the order. Node 0 is the root.
#pragma once

#include "glint/core/vec.h"
#include "glint/cuda/block.h"
#include "glint/render/activations.h"
#include "glint/render/blend.h"
#include "glint/render/morton.h"

namespace glint::gpu {

struct Box {
  Vec3f low, high;
};
GLINT_HD Box empty_box() { return {{1e30f, 1e30f, 1e30f}, {-1e30f, -1e30f, -1e30f}}; }
GLINT_HD Box union_of(const Box& a, const Box& b) {
  return {
      {min_of(a.low.x, b.low.x), min_of(a.low.y, b.low.y), min_of(a.low.z, b.low.z)},
      {max_of(a.high.x, b.high.x), max_of(a.high.y, b.high.y), max_of(a.high.z, b.high.z)}};
}

// A surfel as rays see it.
struct DiscSurfel {
  Vec3f mean, h0, h1, normal;
  float opacity;
  float max_rho;  // squared radius in sigma beyond which it does not count; not positive: nowhere
};
struct TraceCutoffs {
  float near, max_rho, min_alpha, min_transmittance;
  int max_hits;
};
struct DeviceTraceInput {
  std::size_t count;
  int sh_degree;
  const float *means, *scales, *rotations, *opacities, *sh_dc, *sh_rest;
};

struct MakeDiscs {
  DeviceTraceInput input;
  TraceCutoffs cutoffs;
  DiscSurfel* discs;

  GLINT_HD void operator()(std::size_t i) const {
    const float *m = input.means + 3 * i, *q = input.rotations + 4 * i;
    const Mat3f r = rotation_matrix(Vec4f{q[0], q[1], q[2], q[3]});
    DiscSurfel d;
    d.mean = {m[0], m[1], m[2]};
    d.h0 = input.scales[2 * i] * column(r, 0);
    d.h1 = input.scales[2 * i + 1] * column(r, 1);
    d.normal = column(r, 2);
    d.opacity = input.opacities[i];
    const Vec3f sum = d.mean + d.h0 + d.h1;
    const bool finite = abs_of(sum.x + sum.y + sum.z) < 1e30f;  // false for NaN
    d.max_rho = finite ? max_rho_of(d.opacity, cutoffs.max_rho, cutoffs.min_alpha) : -1.0f;
    discs[i] = d;
  }
};

// The box of a disc with a margin for rounding; empty where it counts nowhere.
GLINT_HD Box box_of(const DiscSurfel& d) {
  Box box = empty_box();
  if (!(d.max_rho > 0)) return box;
  for (int axis = 0; axis < 3; ++axis) {
    const float spread = sqrt_of(d.max_rho * (d.h0[axis] * d.h0[axis] + d.h1[axis] * d.h1[axis]));
    const float half = 1.0001f * spread + 1e-6f * abs_of(d.mean[axis]);
    box.low[axis] = d.mean[axis] - half;
    box.high[axis] = d.mean[axis] + half;
  }
  return box;
}

// The union of a block's boxes, to the first.
template <int kThreads, class Block>
GLINT_HD void unite(Block& block, Box* boxes) {
  for (int half = kThreads / 2; half > 0; half /= 2)
    block.each([&](int thread) {
      if (thread < half) boxes[thread] = union_of(boxes[thread], boxes[thread + half]);
    });
}

// Boxes of the centres of runs of discs, one a block.
struct BoundCenters {
  static constexpr int kThreads = 256;
  struct Shared {
    Box boxes[kThreads];
  };
  const DiscSurfel* discs;
  std::size_t count;
  Box* out;  // [blocks]

  template <class Block>
  GLINT_HD void operator()(Block& block, Shared& shared) const {
    block.each([&](int thread) {
      const std::size_t i =
          static_cast<std::size_t>(block.index) * kThreads + static_cast<std::size_t>(thread);
      const bool counts = i < count && discs[i].max_rho > 0;
      shared.boxes[thread] = counts ? Box{discs[i].mean, discs[i].mean} : empty_box();
    });
    unite<kThreads>(block, shared.boxes);
    block.each([&](int thread) {
      if (thread == 0) out[block.index] = shared.boxes[0];
    });
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

// Keys are (Morton code, index): all different.
struct MortonKeys {
  const DiscSurfel* discs;
  const Box* bounds;
  std::uint64_t* keys;
  std::uint32_t* order;

  GLINT_HD void operator()(std::size_t i) const {
    const std::uint32_t code =
        discs[i].max_rho > 0 ? morton_code(discs[i].mean, bounds->low, bounds->high) : ~0u;
    keys[i] = std::uint64_t{code} << 32 | i;
    order[i] = static_cast<std::uint32_t>(i);
  }
};

inline constexpr std::uint32_t kNoParent = ~0u;
struct TreeNode {
  Box box;
  std::uint32_t left, right;  // inner nodes
  std::uint32_t parent;
};

GLINT_HD int leading_zeros(std::uint64_t v) {
#if defined(__CUDA_ARCH__)
  return __clzll(static_cast<long long>(v));
#else
  return v == 0 ? 64 : __builtin_clzll(v);
#endif
}

// Inner node i: the range of keys it covers and where that splits [Karras12 Sec. 4].
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
    return j < 0 || j >= count ? -1 : leading_zeros(keys[i] ^ keys[j]);
  }
  GLINT_HD void link(int i, int split, int first, int last) const {
    const auto leaf = [&](int k) { return static_cast<std::uint32_t>(count - 1 + k); };
    TreeNode& node = nodes[i];
    node.left = first == split ? leaf(split) : static_cast<std::uint32_t>(split);
    node.right = last == split + 1 ? leaf(split + 1) : static_cast<std::uint32_t>(split + 1);
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
  const DiscSurfel* discs;
  const std::uint32_t* order;
  std::size_t count;
  TreeNode* nodes;
  std::uint32_t* arrived;  // [inner nodes] zero

  GLINT_HD void operator()(std::size_t i) const {
    std::uint32_t node = static_cast<std::uint32_t>(count - 1 + i);
    nodes[node].box = box_of(discs[order[i]]);
    while (node != 0 && (node = nodes[node].parent) != kNoParent) {
      if (count_up(&arrived[node]) == 0) return;
      nodes[node].box = union_of(nodes[nodes[node].left].box, nodes[nodes[node].right].box);
    }
  }
};

}  // namespace glint::gpu
