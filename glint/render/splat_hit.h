// SPDX-License-Identifier: MIT
// One splat at one pixel, or at a group of pixels in lanes: the hit test and one step of
// compositing. The text that every rasteriser backend runs.
#pragma once

#include <cstdint>

#include "glint/render/blend.h"
#include "glint/render/splat.h"

namespace glint {

inline constexpr int kTileSize = 8;  // pixels, of the CPU's tiles

// Pixels [x_min, x_max) x [y_min, y_max) a splat can reach; empty for surfels out of view.
struct PixelBox {
  std::int32_t x_min = 0, x_max = 0, y_min = 0, y_max = 0;
  GLINT_HD bool empty() const { return x_min >= x_max || y_min >= y_max; }
  int tile_x_min() const { return x_min / kTileSize; }
  int tile_y_min() const { return y_min / kTileSize; }
  int tile_x_max() const { return (x_max + kTileSize - 1) / kTileSize; }
  int tile_y_max() const { return (y_max + kTileSize - 1) / kTileSize; }
  int tiles_across() const { return tile_x_max() - tile_x_min(); }
  GLINT_HD std::size_t num_pixels() const {
    return empty()
               ? 0
               : static_cast<std::size_t>(x_max - x_min) * static_cast<std::size_t>(y_max - y_min);
  }
  int num_tiles() const { return empty() ? 0 : tiles_across() * (tile_y_max() - tile_y_min()); }
};

// First pixel whose centre is at or right of x, clamped to [0, size].
GLINT_HD int first_pixel(float x, float size) {
  return static_cast<int>(min_of(max_of(ceilf(x - 0.5f), 0.0f), size));
}

// Comparisons are false for NaN, so surfels with broken parameters reach no pixel.
GLINT_HD PixelBox
pixel_box(float x_min, float x_max, float y_min, float y_max, const CameraOf<float>& camera) {
  if (!(x_min <= x_max) || !(y_min <= y_max)) return {};
  return {
      first_pixel(x_min, camera.width),
      first_pixel(x_max, camera.width),
      first_pixel(y_min, camera.height),
      first_pixel(y_max, camera.height)};
}

// Scalars leave at the first test that fails. Lanes do not: most groups have a lane that counts,
// and a mispredicted branch costs more than computing one that has none.
template <class T>
inline constexpr bool kLeavesEarly = kLanesOf<T> == 1;

// Outside `valid` all fields hold harmless values.
template <class T>
struct SplatHit {
  Mask<T> valid;
  Mask<T> in_plane;   // rho comes from the surfel's plane; otherwise from the low-pass
  T x, y;             // offsets from the splat's reference point, pixels
  PlaneHit<T> plane;  // finite where in_plane
  T rho, depth;       // depth: 0 outside `valid`
  SplatAlpha<T> alpha;
  T transmittance;         // before the hit
  T transmittance_behind;  // after it
  T weight;                // 0 outside `valid`
};

// rho and depth of a splat at a pixel. In the low-pass branch the ray misses the surfel by more
// than the pixel's filter: depth is the centre's (Deviation from the official kernels' latest
// state, as in EnvGS: the plane's depth there can be arbitrarily far from the surfel).
template <class T>
GLINT_HD void geometry_of_hit(const Splat& s, const PixelPlaneMap<T>& map, SplatHit<T>& hit) {
  hit.plane = intersect(zeta_at(map, hit.x, hit.y), map.det);
  const T rho3 = squared_radius(hit.plane);
  const T rho2 = low_pass_rho2(hit.x - T(s.center_x), hit.y - T(s.center_y));
  hit.in_plane = rho3 <= rho2;  // false for NaN
  hit.rho = select(hit.in_plane, rho3, rho2);
  hit.depth = select(hit.in_plane, hit.plane.t, T(s.z_center));
}

// d rho/d(shift of the splat's footprint by a pixel): the slope over the screen, of rho at fixed
// pixels. [D] of rho3 = u^2 + v^2 with u = zeta1 / zeta3 and zeta affine in the pixel: moving the
// footprint by s is looking at it from the pixel p - s, so
//   d rho3/ds = -d rho3/dp = -2 (u (g1 - u g3) + v (g2 - v g3)) / zeta3, g = gx or gy;
//   d rho2/ds = -4 (p - c).
template <class T>
GLINT_HD Vec2<T> screen_slope(
    const PixelPlaneMap<T>& map, const SplatHit<T>& hit, T center_x, T center_y
) {
  const PlaneHit<T>& p = hit.plane;
  const auto along = [&](Vec3<T> g, T offset) {
    const T of_plane = T(-2) * p.inverse * (p.u * (g.x - p.u * g.z) + p.v * (g.y - p.v * g.z));
    return select(hit.in_plane, of_plane, T(-4) * offset);
  };
  return {along(map.gx, hit.x - center_x), along(map.gy, hit.y - center_y)};
}

// Whether the splat owns the pixel: counts while more than half of the light is left.
template <class T>
GLINT_HD Mask<T> owns_pixel(const SplatHit<T>& hit) {
  return hit.valid & (hit.transmittance > T(0.5f));
}

// Composites a splat at the pixel centres (x, y), of which only hits behind `nearest` count;
// `map`: the splat's, in lanes. Returns false where no lane has a hit (scalars only; lanes say it
// by weight 0).
template <class T>
GLINT_HD bool composite_splat(
    const Splat& splat,
    const PixelPlaneMap<T>& map,
    T x,
    T y,
    T nearest,
    T& transmittance,
    SplatHit<T>& hit
) {
  hit.transmittance = transmittance;
  if (kLeavesEarly<T> && !any(hit.transmittance > T(0))) return false;
  hit.x = x - T(splat.x_ref);
  hit.y = y - T(splat.y_ref);
  geometry_of_hit(splat, map, hit);
  hit.valid = (hit.rho <= T(kMaxRho)) & (hit.depth > nearest);
  if (kLeavesEarly<T> && !any(hit.valid)) return false;
  // Lanes beyond 3 sigma get the value there: alpha of a far lane would be denormal, which is slow.
  hit.alpha = splat_alpha(T(splat.opacity), min_of(hit.rho, T(kMaxRho)));
  hit.valid = hit.valid & (hit.alpha.alpha >= T(kMinAlpha));
  if (kLeavesEarly<T> && !any(hit.valid)) return false;
  const BlendStep<T> step = blend_step(hit.transmittance, keep(hit.valid, hit.alpha.alpha));
  transmittance = step.transmittance;
  hit.transmittance_behind = step.transmittance;
  hit.weight = step.weight;
  hit.valid = step.weight > T(0);
  hit.depth = keep(hit.valid, hit.depth);
  return true;
}

}  // namespace glint
