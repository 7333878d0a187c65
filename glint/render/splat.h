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
  kSumDet = 9,
  kSumOpacity = 10,
  kSumCenterX = 11,
  kSumCenterY = 12,
  kSumZCenter = 13,
  kSumNormal = 14,  // 3
  kSumExtras = 17   // ExtraSum, where a call has extras; behind them the features' channels
};
enum ExtraSum { kSumPlaneDistance = kSumExtras, kSumScreenAbsX, kSumScreenAbsY, kEndOfExtras };
GLINT_HD constexpr int feature_slot(bool with_extras) {
  return with_extras ? int{kEndOfExtras} : int{kSumExtras};
}
GLINT_HD constexpr int used_sums(int channels, bool with_extras) {
  return feature_slot(with_extras) + channels;
}
// How many a surfel has, in eights.
GLINT_HD constexpr int splat_sums(int channels, bool with_extras) {
  return (used_sums(channels, with_extras) + 7) / 8 * 8;
}
GLINT_HD constexpr int splat_sums(MapChannels has) {
  return splat_sums(has.features, has.has_extras());
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
  f(splat.normal, kSumNormal, 3, maps.normal...);
  if (has.plane_distance) f(&splat.plane_distance, kSumPlaneDistance, 1, maps.plane_distance...);
}

// dL/d(projected) but for the features; sum(slot): a sum over the surfel's pixels.
template <class T, class Sum>
GLINT_HD ProjectedSurfel<T> projected_gradient(MapChannels has, const Sum& sum) {
  const auto sum3 = [&](int slot) { return Vec3<T>{sum(slot), sum(slot + 1), sum(slot + 2)}; };
  ProjectedSurfel<T> g{};
  g.map = {sum3(kSumGx), sum3(kSumGy), sum3(kSumG0), sum(kSumDet)};
  g.center_x = sum(kSumCenterX);
  g.center_y = sum(kSumCenterY);
  g.z_center = sum(kSumZCenter);
  g.normal = sum3(kSumNormal);
  if (has.plane_distance) g.plane_distance = sum(kSumPlaneDistance);
  return g;
}

}  // namespace glint
