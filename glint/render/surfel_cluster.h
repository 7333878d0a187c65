// SPDX-License-Identifier: MIT
// Eight surfels against one ray, one a lane: what every way of finding a ray's hits does with the
// surfels it comes to.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "glint/render/blend.h"
#include "glint/render/intersect.h"
#include "glint/render/nearest_hits.h"
#include "glint/render/surfel_lanes.h"

namespace glint {

// Where a surfel meets a ray; the same operations for one surfel and for eight. e3: h0 x h1.
template <class T>
PlaneHit<T> meet(const SurfelFields<T>& s, Vec3<T> e3, Vec3<T> origin, Vec3<T> direction) {
  const RayPlane<T> plane = ray_plane(s.h0, s.h1, e3, s.mean - origin, direction);
  return intersect(plane.zeta, plane.det);
}
template <class T>
PlaneHit<T> meet(const SurfelFields<T>& s, Vec3<T> origin, Vec3<T> direction) {
  return meet(s, cross(s.h0, s.h1), origin, direction);
}

struct EightSurfels {
  SurfelFields<Float8> fields;
  Vec3<Float8> e3;
  Mask8::Lanes surfels, slots;
};

// Eight surfels of consecutive slots, the fields of TracedSurfel up to max_rho; lanes behind the
// last surfel count nowhere.
struct alignas(64) SurfelCluster {
  static constexpr int kFields = 11;
  Float8 fields[kFields];
  std::uint32_t surfel[Float8::kLanes];

  GLINT_SIMD_INLINE EightSurfels load(std::size_t cluster) const {
    const Float8* f = fields;
    EightSurfels s{
        {{f[0], f[1], f[2]}, {f[3], f[4], f[5]}, {f[6], f[7], f[8]}, f[9], f[10]},
        {},
        load_integers(surfel),
        Mask8::Lanes{0, 1, 2, 3, 4, 5, 6, 7} + static_cast<std::int32_t>(8 * cluster)};
    s.e3 = cross(s.fields.h0, s.fields.h1);
    return s;
  }
};

// Offers eight surfels to the list of a ray.
GLINT_SIMD_INLINE void offer(
    const EightSurfels& s, Vec3<Float8> origin, Vec3<Float8> direction, NearestHits& hits
) {
  const SurfelFields<Float8>& f = s.fields;
  const PlaneHit<Float8> hit = meet(f, s.e3, origin, direction);
  const Float8 rho = squared_radius(hit);
  const Mask8 met =
      (rho <= f.max_rho) & (hit.t >= Float8(hits.after_t())) & (hit.t <= Float8(hits.last_t()));
  if (!any(met)) return;
  const Float8 alpha = splat_alpha(f.opacity, min_of(rho, f.max_rho)).alpha;
  hits.add(hit.t, alpha, met, s.surfels, s.slots);
}

// Slots [N] of surfels at `means` [N][3]: eight consecutive ones are neighbours. Means that are not
// finite come last.
std::vector<std::uint32_t> cluster_slots(std::span<const float> means);

// All surfels, which are in slot order, as clusters.
void make_clusters(const std::vector<TracedSurfel>& surfels, std::vector<SurfelCluster>& clusters);

// The box of a cluster's discs; inverted where none counts anywhere.
struct ClusterBox {
  Vec3f low, high;
};
inline constexpr float kBoxMargin = 1e-4f;  // of the extent: rounding of boxes and of their tests
ClusterBox box_of_cluster(const std::vector<TracedSurfel>& surfels, std::size_t cluster);

}  // namespace glint
