// SPDX-License-Identifier: MIT
// In place of Embree's tree: eight clusters in a row have a node with their
// boxes, eight nodes in a row have one, and so on. Clusters are in an order in which neighbours in
// memory are neighbours in space, so nothing is sorted; a ray finds the same hits as with Embree.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "glint/render/trace_bvh.h"

namespace glint {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kWidth = Float8::kLanes;
constexpr std::size_t kMaxLevels = 11;  // 8^11 clusters are more than 2^31 surfels

// The boxes of eight children; inverted where there is no child.
struct alignas(32) Node {
  float low[3][kWidth], high[3][kWidth];

  void set(std::size_t child, const ClusterBox& box) {
    for (int axis = 0; axis < 3; ++axis)
      low[axis][child] = box.low[axis], high[axis][child] = box.high[axis];
  }
  ClusterBox box() const {
    ClusterBox all;
    for (int axis = 0; axis < 3; ++axis) {
      all.low[axis] = *std::min_element(low[axis], low[axis] + kWidth);
      all.high[axis] = *std::max_element(high[axis], high[axis] + kWidth);
    }
    return all;
  }
};

constexpr ClusterBox kNoBox{
    {kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};

// Nodes over `count` children whose boxes child_box(i) gives.
template <class F>
std::vector<Node> make_level(std::size_t count, F&& child_box) {
  std::vector<Node> nodes((count + kWidth - 1) / kWidth);
  parallel_for(nodes.size(), 32, [&](std::size_t i) {
    for (std::size_t k = 0; k < kWidth; ++k) {
      const std::size_t child = kWidth * i + k;
      nodes[i].set(k, child < count ? child_box(child) : kNoBox);
    }
  });
  return nodes;
}

struct Ray {
  Vec3<Float8> origin, inverse;
  float near;
};

// Where a ray enters the boxes of a node; infinity where it passes them or comes too late.
Float8 entries(const Node& node, const Ray& ray, float last_t) {
  constexpr float kRounding = 1e-6f;  // relative, of the products below
  Float8 enter(ray.near), leave(last_t);
  for (int axis = 0; axis < 3; ++axis) {
    const Float8 a = (Float8::load(node.low[axis]) - ray.origin[axis]) * ray.inverse[axis];
    const Float8 b = (Float8::load(node.high[axis]) - ray.origin[axis]) * ray.inverse[axis];
    enter = max_of(enter, min_of(a, b) * Float8(1 - kRounding));
    leave = min_of(leave, max_of(a, b) * Float8(1 + kRounding));
  }
  const Mask8 is_box = Float8::load(node.low[0]) <= Float8::load(node.high[0]);
  return select((enter <= leave) & is_box, enter, Float8(kInfinity));
}

// 1 / d; a direction without such a part takes forever to leave a slab, not 0 / 0.
float inverse_of(float d) {
  constexpr float kSmallest = 1e-20f;
  return 1 / (std::abs(d) < kSmallest ? std::copysign(kSmallest, d) : d);
}

struct Visit {
  float enter;
  std::uint32_t level, child;  // a node of the level below, or a cluster
};

// What is still to be visited, the nearest on top.
class VisitStack {
 public:
  void push_children(Float8 enter, std::uint32_t level, std::uint32_t node) {
    const std::size_t bottom = size_;
    for (std::uint32_t k = 0; k < kWidth; ++k) {
      if (enter[static_cast<int>(k)] == kInfinity) continue;
      const Visit visit{enter[static_cast<int>(k)], level, 8 * node + k};
      std::size_t at = size_++;
      for (; at > bottom && visits_[at - 1].enter < visit.enter; --at)
        visits_[at] = visits_[at - 1];
      visits_[at] = visit;
    }
  }
  bool empty() const { return size_ == 0; }
  Visit pop() { return visits_[--size_]; }

 private:
  std::array<Visit, kWidth * kMaxLevels> visits_;
  std::size_t size_ = 0;
};

}  // namespace

struct SurfelBvh::Impl {
  std::vector<SurfelCluster> clusters;
  std::vector<std::vector<Node>> levels;  // over clusters, over these nodes, ..., one root
};

SurfelBvh::SurfelBvh() : impl_(std::make_unique<Impl>()) {}
SurfelBvh::~SurfelBvh() = default;

void SurfelBvh::update(const std::vector<TracedSurfel>& surfels, bool) {
  make_clusters(surfels, impl_->clusters);
  impl_->levels.clear();
  impl_->levels.push_back(make_level(impl_->clusters.size(), [&](std::size_t i) {
    return box_of_cluster(surfels, i);
  }));
  while (impl_->levels.back().size() > 1) {
    const std::vector<Node>& below = impl_->levels.back();
    impl_->levels.push_back(make_level(below.size(), [&](std::size_t i) { return below[i].box(); })
    );
  }
}

std::span<const SurfelCluster> SurfelBvh::clusters() const { return impl_->clusters; }

std::size_t SurfelBvh::nearest(Vec3f origin, Vec3f direction, NearestHits& hits) const {
  if (impl_->clusters.empty()) return 0;
  const Vec3<Float8> origins = all_lanes(origin), directions = all_lanes(direction);
  const Vec3f inverse{inverse_of(direction.x), inverse_of(direction.y), inverse_of(direction.z)};
  // Boxes are tested a little before the last hit: theirs and ours round differently.
  const Ray ray{origins, all_lanes(inverse), (1 - kBoxMargin) * hits.after_t()};
  std::size_t looked_at = 0;
  VisitStack stack;
  const auto top = static_cast<std::uint32_t>(impl_->levels.size() - 1);
  stack.push_children(entries(impl_->levels[top][0], ray, hits.last_t()), top, 0);
  while (!stack.empty()) {
    const Visit visit = stack.pop();
    if (visit.enter > hits.last_t()) continue;
    if (visit.level == 0) {
      ++looked_at;
      offer(impl_->clusters[visit.child].load(visit.child), origins, directions, hits);
      continue;
    }
    const Node& node = impl_->levels[visit.level - 1][visit.child];
    stack.push_children(entries(node, ray, hits.last_t()), visit.level - 1, visit.child);
  }
  return looked_at;
}

}  // namespace glint
