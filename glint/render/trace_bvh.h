// SPDX-License-Identifier: MIT
// Finds the surfels that a ray meets, nearest first, on an Embree BVH.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "glint/core/vec.h"
#include "glint/render/intersect.h"

namespace glint {

// A surfel as rays see it.
struct TracedSurfel {
  Vec3f mean, h0, h1, e3;  // e3 = h0 x h1
  Vec3f normal;            // unit, either side
  float opacity;
  float max_rho;  // squared radius in sigma beyond which it does not count; not positive: nowhere
};

inline PlaneHit<float> meet(const TracedSurfel& s, Vec3f origin, Vec3f direction) {
  const RayPlane<float> plane = ray_plane(s.h0, s.h1, s.e3, s.mean - origin, direction);
  return intersect(plane.zeta, plane.det);
}

// Place of a hit on its ray: t, ties by surfel.
struct HitKey {
  float t;
  std::uint32_t surfel;
  bool operator<(const HitKey& other) const {
    return t < other.t || (t == other.t && surfel < other.surfel);
  }
  bool operator==(const HitKey& other) const { return t == other.t && surfel == other.surfel; }
};

// The nearest hits strictly behind `after`, sorted.
struct NearestHits {
  static constexpr int kCapacity = 32;
  HitKey after;
  int count = 0;
  HitKey hits[kCapacity];

  bool full() const { return count == kCapacity; }
  // Returns whether the last place changed while full.
  bool insert(HitKey hit);
};

class SurfelBvh {
 public:
  SurfelBvh();
  ~SurfelBvh();
  SurfelBvh(const SurfelBvh&) = delete;
  SurfelBvh& operator=(const SurfelBvh&) = delete;

  // Keeps a reference to `surfels`. Refits while their number stays, with a rebuild now and then.
  // Errors (kEnvironment): Embree fails.
  void update(const std::vector<TracedSurfel>& surfels, bool triangles);
  void nearest(Vec3f origin, Vec3f direction, NearestHits& hits) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint
