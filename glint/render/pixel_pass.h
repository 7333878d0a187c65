// SPDX-License-Identifier: MIT
// What a pixel (or a group of pixels in lanes) sums over its hits, front to back, and the way back:
// the text of every rasteriser backend. kChannels: feature channels; 0: known at run time only.
#pragma once

#include "glint/render/splat_hit.h"

namespace glint {

inline constexpr int kMaxChannels = 16;

struct DistortionRange {
  bool on = false;
  float near = 0.2f, far = 100.0f;
};

template <class T, int kChannels>
struct PixelSums {
  static constexpr int kRoom = kChannels > 0 ? kChannels : kMaxChannels;
  T features[kRoom], normal[3];
  T depth, median;
  T first_depth, moment1, moment2;  // of the distortion

  GLINT_HD void clear() {
    for (T& feature : features) feature = T(0);
    for (T& axis : normal) axis = T(0);
    depth = median = moment1 = moment2 = T(0);
    first_depth = T(1);
  }
  GLINT_HD void add(
      const SplatHit<T>& hit,
      const float* feature,
      int channels,
      Vec3f splat_normal,
      const DistortionRange& range
  ) {
    for (int c = 0; c < (kChannels > 0 ? kChannels : channels); ++c)
      features[c] = fma_of(hit.weight, T(feature[c]), features[c]);
    depth = fma_of(hit.weight, hit.depth, depth);
    for (int c = 0; c < 3; ++c) normal[c] = fma_of(hit.weight, T(splat_normal[c]), normal[c]);
    const auto is_median = hit.valid & (hit.transmittance > T(0.5f));
    median = select(is_median, hit.depth, median);
    if (range.on) add_moments(hit, range);
  }

 private:
  GLINT_HD void add_moments(const SplatHit<T>& hit, const DistortionRange& range) {
    const T z = select(hit.valid, hit.depth, T(1));
    first_depth = select(hit.valid & (hit.transmittance >= T(1)), z, first_depth);
    const T m = distortion_depth(z, first_depth, T(range.near), T(range.far));
    moment1 = fma_of(hit.weight, m, moment1);
    moment2 = fma_of(hit.weight, m * m, moment2);
  }
};

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
  kSumNormal = 14,   // 3
  kSumFeatures = 17  // channels
};
constexpr int splat_sums(int channels) { return (kSumFeatures + channels + 7) / 8 * 8; }

// dL/d(sums of a pixel), and what the way back needs of the sums themselves.
template <class T, int kChannels>
struct PixelGradient {
  static constexpr int kRoom = kChannels > 0 ? kChannels : kMaxChannels;
  T features[kRoom], normal[3];
  T alpha, depth, median, distortion;
  T total_alpha, first_depth, moment1, moment2;
  T median_behind;  // the median hit is the first to leave this or less
  T remaining;      // S minus the prefix so far, see blend_alpha_vjp

  // From dL/d(outputs) and the outputs, all set but the last two.
  GLINT_HD void start(
      const PixelSums<T, kChannels>& sums, T final_transmittance, int channels, bool with_distortion
  ) {
    median_behind = max_of(T(0.5f), final_transmittance);
    remaining = alpha * total_alpha + depth * sums.depth;
    for (int c = 0; c < (kChannels > 0 ? kChannels : channels); ++c)
      remaining = fma_of(features[c], sums.features[c], remaining);
    for (int c = 0; c < 3; ++c) remaining = fma_of(normal[c], sums.normal[c], remaining);
    // sum w dL/dw of the distortion is twice the distortion itself: it is quadratic in w.
    if (with_distortion)
      remaining += T(2) * distortion * (total_alpha * moment2 - moment1 * moment1);
  }
  // Back through one hit, front to back. out: SplatSum, added to.
  GLINT_HD void hit(
      const SplatHit<T>& hit,
      const Splat& splat,
      const float* feature,
      int channels,
      const DistortionRange& range,
      T* out
  ) {
    T value = fma_of(depth, hit.depth, alpha);
    for (int c = 0; c < (kChannels > 0 ? kChannels : channels); ++c) {
      value = fma_of(features[c], T(feature[c]), value);
      out[kSumFeatures + c] = fma_of(hit.weight, features[c], out[kSumFeatures + c]);
    }
    for (int c = 0; c < 3; ++c) {
      value = fma_of(normal[c], T(splat.normal[c]), value);
      out[kSumNormal + c] = fma_of(hit.weight, normal[c], out[kSumNormal + c]);
    }
    // The last hit in front of which more than half of the light is left.
    const auto is_median =
        (hit.transmittance > T(0.5f)) & (hit.transmittance_behind <= median_behind);
    T dL_dz = fma_of(hit.weight, depth, keep(is_median, median));
    if (range.on) add_distortion(hit, range, value, dL_dz);
    remaining = remaining - hit.weight * value;
    const T dL_dalpha = blend_alpha_vjp(hit.transmittance, hit.alpha.alpha, value, remaining);
    add_geometry(hit, splat, keep(hit.valid, dL_dalpha), keep(hit.valid, dL_dz), out);
  }

 private:
  GLINT_HD void add_distortion(
      const SplatHit<T>& hit, const DistortionRange& range, T& value, T& dL_dz
  ) const {
    const T z = select(hit.valid, hit.depth, T(1));
    const T near(range.near), far(range.far);
    const T m = distortion_depth(z, first_depth, near, far);
    value += distortion * distortion_dweight(m, total_alpha, moment1, moment2);
    const T dL_dm = distortion * distortion_dm(hit.weight, m, total_alpha, moment1);
    dL_dz += distortion_depth_vjp(z, near, far, dL_dm);
  }
  // From alpha and depth of the hit.
  GLINT_HD static void add_geometry(
      const SplatHit<T>& hit, const Splat& splat, T dL_dalpha, T dL_dz, T* out
  ) {
    T dL_drho(0);
    splat_alpha_vjp(T(splat.opacity), hit.alpha, dL_dalpha, out[kSumOpacity], dL_drho);
    const auto in_plane = hit.valid & hit.in_plane;
    const PlaneHit<T> plane{
        keep(in_plane, hit.plane.u),
        keep(in_plane, hit.plane.v),
        keep(in_plane, hit.plane.t),
        keep(in_plane, hit.plane.inverse)};
    const T scale = dL_drho + dL_drho;  // rho = u^2 + v^2
    Vec3<T> dL_dzeta{};
    intersect_vjp(plane, scale * plane.u, scale * plane.v, dL_dz, dL_dzeta, out[kSumDet]);
    for (int k = 0; k < 3; ++k) {
      out[kSumGx + k] = fma_of(dL_dzeta[k], hit.x, out[kSumGx + k]);
      out[kSumGy + k] = fma_of(dL_dzeta[k], hit.y, out[kSumGy + k]);
      out[kSumG0 + k] += dL_dzeta[k];
    }
    const auto low_pass = hit.valid & !hit.in_plane;
    if (!kLeavesEarly<T> || any(low_pass))
      add_low_pass(hit, splat, keep(low_pass, dL_drho), keep(low_pass, dL_dz), out);
  }
  GLINT_HD static void add_low_pass(
      const SplatHit<T>& hit, const Splat& splat, T dL_drho, T dL_dz, T* out
  ) {
    T dL_ddx(0), dL_ddy(0);
    low_pass_rho2_vjp(
        hit.x - T(splat.center_x), hit.y - T(splat.center_y), dL_drho, dL_ddx, dL_ddy
    );
    out[kSumCenterX] += -dL_ddx;
    out[kSumCenterY] += -dL_ddy;
    out[kSumZCenter] += dL_dz;
  }
};

}  // namespace glint
