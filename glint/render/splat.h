// SPDX-License-Identifier: MIT
// One projected surfel as the pixel loops read it, what it gives to all its hits alike, and what
// its pixels hand back to it.
#pragma once

#include <cstdint>

#include "glint/render/project.h"
#include "glint/render/raster_maps.h"

namespace glint {

struct alignas(16) Splat {
  PixelPlaneMap<float> map;
  float x_ref, y_ref, center_x, center_y;
  float opacity, z_center;
  Vec3f normal;
  float plane_distance;
};

GLINT_HD float lane_of(float v, int) { return v; }
template <class T>
GLINT_HD Vec3f lane_of(Vec3<T> v, int i) {
  return {lane_of(v.x, i), lane_of(v.y, i), lane_of(v.z, i)};
}

// The surfel in lane i.
template <class T>
GLINT_HD Splat splat_of(const ProjectedSurfel<T>& p, float opacity, int i = 0) {
  Splat s;
  s.map = {lane_of(p.map.gx, i), lane_of(p.map.gy, i), lane_of(p.map.g0, i), lane_of(p.map.det, i)};
  s.x_ref = lane_of(p.x_ref, i);
  s.y_ref = lane_of(p.y_ref, i);
  s.center_x = lane_of(p.center_x, i);
  s.center_y = lane_of(p.center_y, i);
  s.opacity = opacity;
  s.z_center = lane_of(p.z_center, i);
  s.normal = lane_of(p.normal, i);
  s.plane_distance = lane_of(p.plane_distance, i);
  return s;
}

// The same map in all lanes.
template <class T>
GLINT_HD PixelPlaneMap<T> broadcast_map(const PixelPlaneMap<float>& m) {
  const auto lift = [](Vec3f v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
  return {lift(m.gx), lift(m.gy), lift(m.g0), T(m.det)};
}

// Sums over pixels that one splat hands back to its surfel.
enum SplatSum {
  kSumGx = 0,  // 3: zeta's gradient times X
  kSumGy = 3,  // 3: times Y
  kSumG0 = 6,  // 3
  kSumOpacity = 9,
  kSumCenterX = 10,
  kSumCenterY = 11,
  // From here on SurfaceSum and ExtraSum, of calls that have a surface and extras, and behind them
  // the features' channels.
  kSumSurface = 12
};
enum SurfaceSum {
  kSumDet = kSumSurface,
  kSumZCenter,
  kSumNormal,  // 3
  kEndOfSurface = kSumNormal + 3
};
enum ExtraSum { kSumPlaneDistance = kEndOfSurface, kSumScreenAbsX, kSumScreenAbsY, kEndOfExtras };
GLINT_HD constexpr int feature_slot(bool with_extras, bool with_surface) {
  if (with_extras) return kEndOfExtras;
  return with_surface ? int{kEndOfSurface} : int{kSumSurface};
}
GLINT_HD constexpr int feature_slot(MapChannels has) {
  return feature_slot(has.has_extras(), has.surface);
}
// How many a surfel has, in eights.
GLINT_HD constexpr int in_eights(int sums) { return (sums + 7) / 8 * 8; }
GLINT_HD constexpr int splat_sums(MapChannels has) {
  return in_eights(feature_slot(has) + has.features);
}

// What a splat gives to the maps sum w v, the same v at all its pixels:
// f(v, slot of dL/dv, channels, map of each argument). first_feature: feature_slot() of the call.
template <class F, class... Maps>
GLINT_HD void for_each_attribute(
    const Splat& splat,
    const float* feature,
    MapChannels has,
    int first_feature,
    F&& f,
    Maps&... maps
) {
  f(feature, first_feature, has.features, maps.features...);
  if (has.surface) f(splat.normal, kSumNormal, 3, maps.normal...);
  if (has.plane_distance) f(&splat.plane_distance, kSumPlaneDistance, 1, maps.plane_distance...);
}

// dL/d(projected) but for the features; sum(slot): a sum over the surfel's pixels.
template <class T, class Sum>
GLINT_HD ProjectedSurfel<T> projected_gradient(MapChannels has, const Sum& sum) {
  const auto sum3 = [&](int slot) { return Vec3<T>{sum(slot), sum(slot + 1), sum(slot + 2)}; };
  ProjectedSurfel<T> g{};
  g.map = {sum3(kSumGx), sum3(kSumGy), sum3(kSumG0), T(0)};
  g.center_x = sum(kSumCenterX);
  g.center_y = sum(kSumCenterY);
  if (has.surface) {
    g.map.det = sum(kSumDet);
    g.z_center = sum(kSumZCenter);
    g.normal = sum3(kSumNormal);
  }
  if (has.plane_distance) g.plane_distance = sum(kSumPlaneDistance);
  return g;
}

}  // namespace glint
