// SPDX-License-Identifier: MIT
// Finds the surfels that a ray meets, nearest first, on an Embree BVH. Surfels are kept in an order
// in which neighbours in space are neighbours in memory; their place in it is called slot. Eight in
// a row are one primitive of the tree and tested at once, one a lane.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "glint/core/vec.h"
#include "glint/render/intersect.h"
#include "glint/render/nearest_hits.h"
#include "glint/render/surfel_lanes.h"

namespace glint {

// Slots [N] of surfels at `means` [N][3], along a Morton curve. Means that are not finite come
// last.
std::vector<std::uint32_t> morton_slots(std::span<const float> means);

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
  // Adds the hits behind hits.after().
  void nearest(Vec3f origin, Vec3f direction, NearestHits& hits) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint
