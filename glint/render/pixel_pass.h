// SPDX-License-Identifier: MIT
// What a pixel (or a group of pixels in lanes) sums over its hits, front to back, and the way back:
// the text of every rasteriser backend.
#pragma once

#include <utility>

#include "glint/render/raster_maps.h"
#include "glint/render/splat_hit.h"

namespace glint {

inline constexpr int kMaxChannels = 16;

// Feature channels with code of their own: those that methods use. Others share one.
using ChannelCounts = std::integer_sequence<int, 3, 4, 5>;

// What the code of a pass knows of its call. kFeatures: feature channels; 0: known at run time
// only. kExtras, kSurface: false: the call has none (MapChannels), and its code nothing of them.
template <int kFeatures_, bool kExtras_, bool kSurface_>
struct PassCode {
  static constexpr int kFeatures = kFeatures_;
  static constexpr bool kExtras = kExtras_, kSurface = kSurface_;
  static constexpr int kMostFeatures = kFeatures > 0 ? kFeatures : kMaxChannels;
  static constexpr int kFeatureSlot = feature_slot(kExtras, kSurface);
  static constexpr int kUsedSums = kFeatureSlot + kMostFeatures;
  static constexpr int kSums = in_eights(kUsedSums);

  // The same call, what is known of it as constants.
  GLINT_HD static constexpr MapChannels known(MapChannels has) {
    if (kFeatures > 0) has.features = kFeatures;
    has.plane_distance = kExtras && has.plane_distance;
    has.statistics = kExtras && has.statistics;
    has.surface = kSurface;
    if (kFeatures == kColorChannels) has.detached = 0;
    return has;
  }
};

// body<PassCode>() with the code of such calls.
template <class F>
void with_pass_code(MapChannels has, F&& body) {
  const auto with_features = [&]<int kFeatures>() {
    if (has.has_extras())
      body.template operator()<PassCode<kFeatures, true, true>>();
    else
      body.template operator()<PassCode<kFeatures, false, true>>();
  };
  if (!has.surface) return body.template operator()<PassCode<kColorChannels, false, false>>();
  [&]<int... kCounts>(std::integer_sequence<int, kCounts...>) {
    const bool found =
        ((has.features == kCounts && (with_features.template operator()<kCounts>(), true)) || ...);
    if (!found) with_features.template operator()<0>();
  }
  (ChannelCounts{});
}

struct DistortionRange {
  bool on = false;
  float near = 0.2f, far = 100.0f;
};

// f(c) for the first `width` of an array's places. On GPUs with constant bounds, so that the array
// stays in registers.
template <class T, int kMost, class F>
GLINT_HD void for_channels(const T (&)[kMost], int width, F&& f) {
#if defined(__CUDA_ARCH__)
#pragma unroll
  for (int c = 0; c < kMost; ++c)
    if (c < width) f(c);
#else
  for (int c = 0; c < width; ++c) f(c);
#endif
}

// A pixel's numbers as the lists of raster_maps.h hold them.
template <class T>
struct PixelOf {
  template <int kWidth>
  using Map = T[kWidth > 0 ? kWidth : kMaxChannels];
};
template <class T, class Code>
using PixelMaps = RasterMaps<PixelOf<T>::template Map, Code::kFeatures>;
template <class T>
using PixelKept = KeptMaps<PixelOf<T>::template Map>;

template <class T, class Code>
struct PixelSums {
  PixelMaps<T, Code> maps;
  PixelKept<T> kept;

  GLINT_HD void clear() {
    for_each_map(
        {Code::kMostFeatures, true, Code::kExtras},
        [](const char*, int width, auto& values) {
          for_channels(values, width, [&](int c) { values[c] = T(0); });
        },
        maps
    );
    for_each_kept_map(
        {0, true}, [](int, float empty, T* value) { *value = T(empty); }, kept
    );
  }
  GLINT_HD void add(
      const SplatHit<T>& hit,
      const Splat& splat,
      const float* feature,
      MapChannels has,
      const DistortionRange& range
  ) {
    for_each_attribute(
        splat,
        feature,
        Code::known(has),
        Code::kFeatureSlot,
        [&](const auto& value, int, int width, auto& sum) {
          for_channels(sum, width, [&](int c) {
            sum[c] = fma_of(hit.weight, T(value[c]), sum[c]);
          });
        },
        maps
    );
    if (Code::known(has).surface) {
      *maps.depth_sum = fma_of(hit.weight, hit.depth, *maps.depth_sum);
      *maps.depth_median = select(owns_pixel(hit), hit.depth, *maps.depth_median);
    }
    if (range.on) add_moments(hit, range);
  }
  // Behind the last hit.
  GLINT_HD void finish(T transmittance, const DistortionRange& range) {
    *kept.transmittance = transmittance;
    *maps.alpha = T(1) - transmittance;
    if (range.on) *maps.distortion = distortion(*maps.alpha, *kept.moment1, *kept.moment2);
  }

 private:
  GLINT_HD void add_moments(const SplatHit<T>& hit, const DistortionRange& range) {
    T& first = *kept.first_depth;
    const T z = select(hit.valid, hit.depth, T(1));
    first = select(hit.valid & (hit.transmittance >= T(1)), z, first);
    const T m = distortion_depth(z, first, T(range.near), T(range.far));
    *kept.moment1 = fma_of(hit.weight, m, *kept.moment1);
    *kept.moment2 = fma_of(hit.weight, m * m, *kept.moment2);
  }
};

// dL/d(what a hit is made of), at one pixel.
template <class T>
struct HitGradient {
  T opacity, rho, depth;
};

// dL/d(maps of a pixel), and what the way back needs of the maps themselves.
template <class T, class Code>
struct PixelGradient {
  PixelMaps<T, Code> dL;
  PixelKept<T> kept;
  T median_behind;  // transmittance at or below which a hit may be the median
  T remaining;      // sum w dL/dw of the hits not met yet

  // From the maps, dL/d(maps) and `kept`; before the first hit.
  GLINT_HD void start(const PixelMaps<T, Code>& maps, MapChannels has) {
    has = Code::known(has);
    median_behind = max_of(T(0.5f), *kept.transmittance);
    remaining = *dL.alpha * *maps.alpha;
    if (has.surface) remaining += *dL.depth_sum * *maps.depth_sum;
    for_each_attribute(
        Splat{},  // no values are looked at
        nullptr,
        has,
        Code::kFeatureSlot,
        [&](const auto&, int slot, int width, const auto& gradient, const auto& sum) {
          for_channels(sum, width, [&](int c) {
            if (is_blended(slot, c, has)) remaining = fma_of(gradient[c], sum[c], remaining);
          });
        },
        dL,
        maps
    );
    // sum w dL/dw of the distortion is twice the distortion itself: it is quadratic in w.
    if (has.distortion)
      remaining +=
          T(2) * *dL.distortion * (*maps.alpha * *kept.moment2 - *kept.moment1 * *kept.moment1);
  }
  // Back through one hit: through() and add() in one.
  GLINT_HD void hit(
      const SplatHit<T>& hit,
      const Splat& splat,
      const float* feature,
      MapChannels has,
      const DistortionRange& range,
      T* out
  ) {
    add(hit, through(hit, splat, feature, has, range), splat, has, out);
  }
  // Through the compositing, in the order of the hits, front to back.
  GLINT_HD HitGradient<T> through(
      const SplatHit<T>& hit,
      const Splat& splat,
      const float* feature,
      MapChannels has,
      const DistortionRange& range
  ) {
    has = Code::known(has);
    T value = *dL.alpha;
    if (has.surface) value = fma_of(*dL.depth_sum, hit.depth, value);
    for_each_attribute(
        splat,
        feature,
        has,
        Code::kFeatureSlot,
        [&](const auto& attribute, int slot, int width, const auto& gradient) {
          for_channels(gradient, width, [&](int c) {
            if (is_blended(slot, c, has)) value = fma_of(gradient[c], T(attribute[c]), value);
          });
        },
        dL
    );
    T dL_dz = has.surface ? depth_gradient(hit) : T(0);
    if (range.on) add_distortion(hit, range, value, dL_dz);
    remaining = remaining - hit.weight * value;
    const T dL_dalpha = blend_alpha_vjp(hit.transmittance, hit.alpha.alpha, value, remaining);
    HitGradient<T> g{T(0), T(0), keep(hit.valid, dL_dz)};
    splat_alpha_vjp(T(splat.opacity), hit.alpha, keep(hit.valid, dL_dalpha), g.opacity, g.rho);
    return g;
  }
  // What through() returned, to the splat. out: SplatSum and ExtraSum, added to. In three parts
  // that share no sums.
  GLINT_HD void add(
      const SplatHit<T>& hit, const HitGradient<T>& g, const Splat& splat, MapChannels has, T* out
  ) const {
    add_attributes(hit, splat, has, out);
    add_alpha(hit, g, splat, has, out);
    add_geometry(hit, g, splat, out);
  }
  GLINT_HD void add_attributes(const SplatHit<T>& hit, const Splat& splat, MapChannels has, T* out)
      const {
    for_each_attribute(
        splat,
        nullptr,
        Code::known(has),
        Code::kFeatureSlot,
        [&](const auto&, int slot, int width, const auto& gradient) {
          for_channels(gradient, width, [&](int c) {
            out[slot + c] = fma_of(hit.weight, gradient[c], out[slot + c]);
          });
        },
        dL
    );
  }
  GLINT_HD static void add_alpha(
      const SplatHit<T>& hit, const HitGradient<T>& g, const Splat& splat, MapChannels has, T* out
  ) {
    out[kSumOpacity] += g.opacity;
    if (Code::known(has).statistics) add_screen_abs(hit, splat, g.rho, &out[kSumScreenAbsX]);
  }
  // From rho and depth of the hit.
  GLINT_HD static void add_geometry(
      const SplatHit<T>& hit, const HitGradient<T>& g, const Splat& splat, T* out
  ) {
    const auto in_plane = hit.valid & hit.in_plane;
    const PlaneHit<T> plane{
        keep(in_plane, hit.plane.u),
        keep(in_plane, hit.plane.v),
        keep(in_plane, hit.plane.t),
        keep(in_plane, hit.plane.inverse)};
    const T scale = g.rho + g.rho;  // rho = u^2 + v^2
    Vec3<T> dL_dzeta{};
    T dL_ddet(0);
    intersect_vjp(plane, scale * plane.u, scale * plane.v, g.depth, dL_dzeta, dL_ddet);
    if (Code::kSurface) out[kSumDet] += dL_ddet;
    for (int k = 0; k < 3; ++k) {
      out[kSumGx + k] = fma_of(dL_dzeta[k], hit.x, out[kSumGx + k]);
      out[kSumGy + k] = fma_of(dL_dzeta[k], hit.y, out[kSumGy + k]);
      out[kSumG0 + k] += dL_dzeta[k];
    }
    const auto low_pass = hit.valid & !hit.in_plane;
    if (any(low_pass))  // few surfels have any, but then at most pixels
      add_low_pass(hit, splat, keep(low_pass, g.rho), keep(low_pass, g.depth), out);
  }

 private:
  // Whether the gradient of a channel of an attribute goes to the weights that blend it.
  GLINT_HD static bool is_blended(int slot, int channel, MapChannels has) {
    return slot != Code::kFeatureSlot || !has.is_detached(channel);
  }
  // Of its depth in the sum and as the median: the last hit in front of which more than half of the
  // light is left.
  GLINT_HD T depth_gradient(const SplatHit<T>& hit) const {
    const auto is_median =
        (hit.transmittance > T(0.5f)) & (hit.transmittance_behind <= median_behind);
    return fma_of(hit.weight, *dL.depth_sum, keep(is_median, *dL.depth_median));
  }
  GLINT_HD T total_alpha() const { return T(1) - *kept.transmittance; }
  GLINT_HD void add_distortion(
      const SplatHit<T>& hit, const DistortionRange& range, T& value, T& dL_dz
  ) const {
    const T z = select(hit.valid, hit.depth, T(1));
    const T near(range.near), far(range.far);
    const T m = distortion_depth(z, *kept.first_depth, near, far);
    value += *dL.distortion * distortion_dweight(m, total_alpha(), *kept.moment1, *kept.moment2);
    const T dL_dm = *dL.distortion * distortion_dm(hit.weight, m, total_alpha(), *kept.moment1);
    dL_dz += distortion_depth_vjp(z, near, far, dL_dm);
  }
  // |dL/d(shift of the footprint by a pixel)| at this pixel: of what the hit's alpha does, as in
  // [Ye24a, AbsGS]; its depth's part is left out. out: x and y, added to.
  GLINT_HD static void add_screen_abs(
      const SplatHit<T>& hit, const Splat& splat, T dL_drho, T* out
  ) {
    const PixelPlaneMap<T> map = broadcast_map<T>(splat.map);
    const Vec2<T> slope = screen_slope(map, hit, T(splat.center_x), T(splat.center_y));
    // Outside `valid` the slope may be infinite.
    out[0] += keep(hit.valid, abs_of(dL_drho * slope.x));
    out[1] += keep(hit.valid, abs_of(dL_drho * slope.y));
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
    if (Code::kSurface) out[kSumZCenter] += dL_dz;
  }
};

}  // namespace glint
