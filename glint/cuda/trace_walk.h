// SPDX-License-Identifier: MIT
// A ray's nearest hits, found in the tree a few at a time, in the order (t, surfel), up to where
// the ray stops. One thread a ray.
#pragma once

#include "glint/cuda/wide_nodes.h"

namespace glint::gpu {

// What a ray costs, for those who ask (tests); kernels count nothing.
struct WalkCounts {
  static constexpr bool kCounts = true;
  std::uint32_t nodes = 0, discs = 0, hits = 0, searches = 0;
  GLINT_HD void node() { ++nodes; }
  GLINT_HD void disc() { ++discs; }
  GLINT_HD void hit() { ++hits; }
  GLINT_HD void search() { ++searches; }
};
struct NoCounts {
  static constexpr bool kCounts = false;
  GLINT_HD void node() {}
  GLINT_HD void disc() {}
  GLINT_HD void hit() {}
  GLINT_HD void search() {}
};

inline constexpr float kNoHit = 2e30f, kFarthest = 1e30f;

// A hit's place on its ray.
struct HitKey {
  float t;
  std::uint32_t surfel;
  GLINT_HD bool before(const HitKey& other) const {
    return t < other.t || (t == other.t && surfel < other.surfel);
  }
};

// The first hits behind `after`, in order. In registers: no index depends on the data.
template <int kCapacity>
class NearestList {
 public:
  GLINT_HD explicit NearestList(float near) : after_{max_of(near, 0.0f), ~0u} {}
  GLINT_HD void start() {
    unrolled<kCapacity>([&](int k) { hits_[k] = none(); });
  }
  GLINT_HD float after_t() const { return after_.t; }
  // Hits behind it do not matter.
  GLINT_HD float last_t() const { return min_of(hits_[kCapacity - 1].t, kFarthest); }
  GLINT_HD void insert(HitKey hit) {
    if (!(hit.t <= last_t()) || !after_.before(hit)) return;
    unrolled<kCapacity>([&](int k) {
      if (!hit.before(hits_[k])) return;
      const HitKey moved = hits_[k];
      hits_[k] = hit;
      hit = moved;
    });
  }
  // f(surfel) for each in order until it returns false; whether there may be more behind them.
  template <class F>
  GLINT_HD bool give(F&& f) {
    const bool full = hits_[kCapacity - 1].t < kFarthest;
    while (hits_[0].t < kFarthest) {
      if (!f(hits_[0].surfel)) return false;
      after_ = hits_[0];
      unrolled<kCapacity - 1>([&](int k) { hits_[k] = hits_[k + 1]; });
      hits_[kCapacity - 1] = none();
    }
    return full;
  }

 private:
  GLINT_HD static HitKey none() { return {kNoHit, ~0u}; }
  HitKey after_, hits_[kCapacity];
};

struct Tree {
  const WideNode* wide;
  const TreeNode* nodes;
  const Disc* discs;             // by slot
  const std::uint32_t* slot_of;  // [surfels]
};

// What is still to be walked: a thread's part of its block's memory. It may be full: what does not
// fit is walked disc by disc, which is correct and, that deep in the tree, short.
template <int kThreads, int kRoom = 24>
struct WalkStack {
  static constexpr int kDepth = kRoom;
  float entries[kDepth][kThreads];
  ChildRef children[kDepth][kThreads];
};

struct WalkedRay {
  Vec3f origin, direction, inverse;

  GLINT_HD WalkedRay(Vec3f from, Vec3f along)
      : origin(from),
        direction(along),
        inverse{inverse_of(along.x), inverse_of(along.y), inverse_of(along.z)} {}

 private:
  GLINT_HD static float inverse_of(float v) {
    return abs_of(v) > 1e-20f ? 1 / v : (v < 0 ? -1e20f : 1e20f);
  }
};

// Where a ray enters a child, behind 0; kNoHit where it does not, where that is behind what the
// list wants, or where it leaves before. An empty box has its near sides behind its far ones.
template <class List>
GLINT_HD float entry(const WideNode& node, int k, const WalkedRay& ray, const List& list) {
  constexpr float kRounding = 1.00001f;
  float in = 0, out = kFarthest;
  for (int axis = 0; axis < 3; ++axis) {
    const bool forward = ray.inverse[axis] >= 0;
    const float a = (node.low[axis][k] - ray.origin[axis]) * ray.inverse[axis];
    const float b = (node.high[axis][k] - ray.origin[axis]) * ray.inverse[axis];
    in = max_of(in, forward ? a : b);
    out = min_of(out, forward ? b : a);
  }
  out *= kRounding;
  return in <= out && out >= list.after_t() && in <= list.last_t() * kRounding ? in : kNoHit;
}

template <class List, class Stack, class Counts>
class TreeWalk {
 public:
  GLINT_HD TreeWalk(
      const Tree& tree, const WalkedRay& ray, Stack& stack, int thread, Counts& counts
  )
      : tree_(tree), ray_(ray), stack_(stack), thread_(thread), counts_(counts) {}

  GLINT_HD void nearest(List& list) {
    counts_.search();
    size_ = 0;
    open(0, list);
    while (size_ > 0) {
      --size_;
      if (stack_.entries[size_][thread_] > list.last_t() * 1.00001f) continue;
      const ChildRef child = stack_.children[size_][thread_];
      if (child.is_leaf())
        test(child.first(), child.count(), list);
      else
        open(child.node(), list);
    }
  }

 private:
  // Pushes the children that the ray enters, the nearest last.
  GLINT_HD void open(std::uint32_t index, List& list) {
    counts_.node();
    const WideNode& node = tree_.wide[index];
    float entries[kWidth];
    ChildRef children[kWidth];
    unrolled<kWidth>([&](int k) {
      entries[k] = entry(node, k, ray_, list);
      children[k] = node.children[k];
    });
    unrolled<kWidth>([&](int pass) {  // farthest first, by swaps of neighbours
      unrolled<kWidth - 1>([&](int k) {
        if (k % 2 != pass % 2 || entries[k] >= entries[k + 1]) return;
        const float entry = entries[k];
        const ChildRef child = children[k];
        entries[k] = entries[k + 1], children[k] = children[k + 1];
        entries[k + 1] = entry, children[k + 1] = child;
      });
    });
    unrolled<kWidth>([&](int k) {
      if (entries[k] < kFarthest) push(entries[k], children[k], list);
    });
  }
  GLINT_HD void push(float entry, ChildRef child, List& list) {
    if (size_ < Stack::kDepth) {
      stack_.entries[size_][thread_] = entry;
      stack_.children[size_][thread_] = child;
      ++size_;
    } else if (child.is_leaf()) {
      test(child.first(), child.count(), list);
    } else {
      const TreeNode& node = tree_.nodes[child.node()];
      test(node.first, node.count, list);
    }
  }
  GLINT_HD void test(std::uint32_t first, std::uint32_t count, List& list) {
    for (std::uint32_t slot = first; slot < first + count; ++slot) {
      counts_.disc();
      const Disc& disc = tree_.discs[slot];
      const PlaneHit<float> hit = meet(disc, ray_.origin, ray_.direction);
      if (squared_radius(hit) <= disc.max_rho) list.insert({hit.t, disc.surfel});
    }
  }

  const Tree& tree_;
  const WalkedRay& ray_;
  Stack& stack_;
  int thread_, size_ = 0;
  Counts& counts_;
};

}  // namespace glint::gpu
