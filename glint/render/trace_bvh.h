// SPDX-License-Identifier: MIT
// Finds the surfels that a ray meets, nearest first, on an Embree BVH. Surfels are kept in an order
// in which neighbours in space are neighbours in memory; their place in it is called slot. Eight in
// a row are one primitive of the tree and tested at once, one a lane.
#pragma once

#include <bit>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "glint/core/vec.h"
#include "glint/render/blend.h"
#include "glint/render/intersect.h"
#include "glint/render/surfel_lanes.h"

namespace glint {

// Slots of surfels at `means` [N][3]: surfel_of_slot[N], along a Morton curve. Means that are not
// finite come last.
std::vector<std::uint32_t> morton_order(std::span<const float> means);

// Where a surfel meets a ray; the same operations for one surfel and for eight.
template <class T>
PlaneHit<T> meet(const SurfelFields<T>& s, Vec3<T> origin, Vec3<T> direction) {
  const RayPlane<T> plane = ray_plane(s.h0, s.h1, cross(s.h0, s.h1), s.mean - origin, direction);
  return intersect(plane.zeta, plane.det);
}
template <class T>
T squared_radius(const PlaneHit<T>& hit) {
  return fma_of(hit.u, hit.u, hit.v * hit.v);
}

// Place of a hit on its ray: t >= 0, ties by surfel. The bits of such floats are ordered as they
// are, so that one integer holds both.
using HitKey = std::uint64_t;
inline HitKey hit_key(float t, std::uint32_t surfel) {
  return HitKey{std::bit_cast<std::uint32_t>(t + 0.0f)} << 32 | surfel;  // -0 becomes 0
}
inline float hit_t(HitKey key) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32));
}

struct FoundHit {
  HitKey key;
  std::uint32_t slot;
  float alpha;
};

// The nearest hits strictly behind `after`, sorted.
struct NearestHits {
  static constexpr int kCapacity = 32;
  HitKey after;
  float min_alpha;  // fainter ones do not count
  int count = 0;
  FoundHit hits[kCapacity];

  bool full() const { return count == kCapacity; }
  const FoundHit& last() const { return hits[count - 1]; }
  void insert(FoundHit hit);
};

class SurfelBvh {
 public:
  SurfelBvh();
  ~SurfelBvh();
  SurfelBvh(const SurfelBvh&) = delete;
  SurfelBvh& operator=(const SurfelBvh&) = delete;

  // Keeps a reference to `surfels`, in slot order. `refit`: the tree of the last call may be kept;
  // for surfels that are the same ones in the same slots.
  // Errors (kEnvironment): Embree fails.
  void update(const std::vector<TracedSurfel>& surfels, bool triangles, bool refit);
  void nearest(Vec3f origin, Vec3f direction, NearestHits& hits) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint
