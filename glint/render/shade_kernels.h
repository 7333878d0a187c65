// SPDX-License-Identifier: MIT
// Activation of surfels and the way back (shade.h), for as many surfels from i on as T has lanes.
// Kernels of both devices.
#pragma once

#include "glint/core/kernel.h"
#include "glint/core/unrolled.h"
#include "glint/render/activations.h"
#include "glint/render/spherical_harmonics.h"

namespace glint {

inline constexpr int kMaxExtra = 16;

// Parameter arrays of a cloud (SurfelCloud), or of its gradient with F = float.
template <class F>
struct CloudArrays {
  F *means, *log_scales, *rotations, *opacity_logits, *sh_dc, *sh_rest, *extra_logits;
  int num_extra;
  int shown_extra;             // of those, among the features: all or none
  int opacity_factor;          // extra channel that opacities are multiplied by; negative: none
  const float* color_offsets;  // [N][3], may be null
  Activation kinds[kMaxExtra];
};
using CloudPointers = CloudArrays<const float>;
using CloudGradientPointers = CloudArrays<float>;

template <class T>
GLINT_HD Vec3<T> load3_strided(const float* array, std::size_t i) {
  const float* p = array + 3 * i;
  return {load_strided<T>(p, 3), load_strided<T>(p + 1, 3), load_strided<T>(p + 2, 3)};
}

// Unit direction from the eye to a surfel, and its length.
template <class T>
struct ViewDirection {
  Vec3<T> unit;
  T norm;
};
template <class T>
GLINT_HD ViewDirection<T> view_direction(const CloudPointers& cloud, Vec3f eye, std::size_t i) {
  const Vec3<T> d = load3_strided<T>(cloud.means, i) - Vec3<T>{T(eye.x), T(eye.y), T(eye.z)};
  const T norm = max_of(length(d), T(1e-12f));
  return {(T(1) / norm) * d, norm};
}

// f(k) for coefficients [kFirst, count); for a GPU to a bound that the compiler knows, so that
// arrays indexed by k stay in registers.
template <int kFirst, class F>
GLINT_HD void each_coefficient(int count, F&& f) {
#if defined(__CUDA_ARCH__)
  unrolled<16 - kFirst>([&](int k) {
    if (kFirst + k < count) f(kFirst + k);
  });
#else
  for (int k = kFirst; k < count; ++k) f(k);
#endif
}
template <class T>
GLINT_HD T sh_coefficient(const CloudPointers& cloud, std::size_t i, int k, int c) {
  return k == 0 ? load_strided<T>(cloud.sh_dc + 3 * i + c, 3)
                : load_strided<T>(cloud.sh_rest + 45 * i + 3 * (k - 1) + c, 45);
}
// What is added to a clamped colour.
template <class T>
GLINT_HD T color_offset(const CloudPointers& cloud, std::size_t i, int c) {
  return cloud.color_offsets == nullptr ? T(0)
                                        : load_strided<T>(cloud.color_offsets + 3 * i + c, 3);
}
template <class T>
GLINT_HD T sh_sum(const CloudPointers& cloud, std::size_t i, int count, const T basis[16], int c) {
  T sum(0);
  each_coefficient<0>(count, [&](int k) {
    sum = fma_of(basis[k], sh_coefficient<T>(cloud, i, k, c), sum);
  });
  return sum;
}

// Raw value of an extra channel.
template <class T>
GLINT_HD T raw_extra(const CloudPointers& cloud, std::size_t i, int e) {
  return load_strided<T>(
      cloud.extra_logits + i * static_cast<std::size_t>(cloud.num_extra) + e, cloud.num_extra
  );
}
template <class T>
GLINT_HD T extra_value(const CloudPointers& cloud, std::size_t i, int e) {
  return activated(cloud.kinds[e], raw_extra<T>(cloud, i, e));
}

struct ActivateGeometry {
  CloudPointers cloud;
  float *scales, *opacities;

  template <class T>
  GLINT_HD void lanes(std::size_t i) const {
    for (std::size_t at = 2 * i; at < 2 * i + 2; ++at)
      store_strided(scales + at, 2, exp_fast(load_strided<T>(cloud.log_scales + at, 2)));
    T opacity = sigmoid(load_strided<T>(cloud.opacity_logits + i, 1));
    if (cloud.opacity_factor >= 0)
      opacity = opacity * extra_value<T>(cloud, i, cloud.opacity_factor);
    store_strided(opacities + i, 1, opacity);
  }
  GLINT_HD void operator()(std::size_t i) const { lanes<float>(i); }
};

struct ActivateFeatures {
  CloudPointers cloud;
  Vec3f eye;
  int degree;
  float* features;  // [N][3 + shown_extra]

  template <class T>
  GLINT_HD void lanes(std::size_t i) const {
    T basis[16];
    sh_basis(degree, view_direction<T>(cloud, eye, i).unit, basis);
    const int channels = 3 + cloud.shown_extra;
    float* to = features + i * static_cast<std::size_t>(channels);
    for (int c = 0; c < 3; ++c) {
      const T color = sh_color(sh_sum(cloud, i, sh_coefficients(degree), basis, c));
      store_strided(to + c, channels, color + color_offset<T>(cloud, i, c));
    }
    for (int e = 0; e < cloud.shown_extra; ++e)
      store_strided(to + 3 + e, channels, extra_value<T>(cloud, i, e));
  }
  GLINT_HD void operator()(std::size_t i) const { lanes<float>(i); }
};

// dL/d(activated) of rasterize().
struct ActivatedGradient {
  const float *means, *scales, *rotations, *opacities, *features;
};

struct ActivateVjp {
  CloudPointers cloud;
  Vec3f eye;
  int degree;
  const float *scales, *opacities, *features;  // activated
  ActivatedGradient g;
  CloudGradientPointers out;  // added to
  bool with_rest = true;      // sh_rest, too; else ShRestVjp does it

  template <class T>
  GLINT_HD void lanes(std::size_t i) const {
    colors<T>(i);
    for (std::size_t at = 2 * i; at < 2 * i + 2; ++at)
      add_strided(
          out.log_scales + at,
          2,
          exp_vjp(load_strided<T>(scales + at, 2), load_strided<T>(g.scales + at, 2))
      );
    for (std::size_t at = 4 * i; at < 4 * i + 4; ++at)
      add_strided(out.rotations + at, 4, load_strided<T>(g.rotations + at, 4));
    opacity<T>(i);
    extra<T>(i);
  }
  GLINT_HD void operator()(std::size_t i) const { lanes<float>(i); }

  // dL/d(sum of spherical harmonics) of a channel; exactly 0 where the colour was clamped.
  template <class T>
  GLINT_HD T sum_gradient(std::size_t i, int c) const {
    const std::size_t at = i * static_cast<std::size_t>(channels()) + static_cast<std::size_t>(c);
    const T color = load_strided<T>(features + at, channels()) - color_offset<T>(cloud, i, c);
    return clamped_color_vjp(color, load_strided<T>(g.features + at, channels()));
  }

 private:
  GLINT_HD int channels() const { return 3 + cloud.shown_extra; }
  template <class T>
  GLINT_HD void opacity(std::size_t i) const {
    const T dL_dopacity = load_strided<T>(g.opacities + i, 1);
    if (cloud.opacity_factor < 0) {
      const T value = load_strided<T>(opacities + i, 1);
      return add_strided(out.opacity_logits + i, 1, sigmoid_vjp(value, dL_dopacity));
    }
    const T own = sigmoid(load_strided<T>(cloud.opacity_logits + i, 1));
    const T factor = extra_value<T>(cloud, i, cloud.opacity_factor);
    add_strided(out.opacity_logits + i, 1, sigmoid_vjp(own, dL_dopacity * factor));
    add_extra(i, cloud.opacity_factor, factor, dL_dopacity * own);
  }
  // Adds to the raw value of an extra channel.
  template <class T>
  GLINT_HD void add_extra(std::size_t i, int e, T value, T dL_dvalue) const {
    const T raw = raw_extra<T>(cloud, i, e);
    add_strided(
        out.extra_logits + i * static_cast<std::size_t>(cloud.num_extra) + e,
        cloud.num_extra,
        activated_vjp(cloud.kinds[e], raw, value, dL_dvalue)
    );
  }
  template <class T>
  GLINT_HD void colors(std::size_t i) const {
    const ViewDirection<T> view = view_direction<T>(cloud, eye, i);
    const int count = sh_coefficients(degree);
    T basis[16], dL_dbasis[16];
    sh_basis(degree, view.unit, basis);
    each_coefficient<0>(count, [&](int k) { dL_dbasis[k] = T(0); });
    for (int c = 0; c < 3; ++c) {
      const T dL_dsum = sum_gradient<T>(i, c);
      add_strided(out.sh_dc + 3 * i + c, 3, dL_dsum * basis[0]);
      each_coefficient<1>(count, [&](int k) {
        if (with_rest) add_strided(out.sh_rest + 45 * i + 3 * (k - 1) + c, 45, dL_dsum * basis[k]);
        dL_dbasis[k] = fma_of(dL_dsum, sh_coefficient<T>(cloud, i, k, c), dL_dbasis[k]);
      });
    }
    Vec3<T> dL_dd{};
    sh_basis_vjp(degree, view.unit, dL_dbasis, dL_dd);
    const Vec3<T> dL_dmean = normalize_vjp(view.unit, view.norm, dL_dd);
    for (int axis = 0; axis < 3; ++axis) {
      const std::size_t at = 3 * i + static_cast<std::size_t>(axis);
      add_strided(out.means + at, 3, load_strided<T>(g.means + at, 3) + dL_dmean[axis]);
    }
  }
  template <class T>
  GLINT_HD void extra(std::size_t i) const {
    const std::size_t row = i * static_cast<std::size_t>(channels()) + 3;
    for (int e = 0; e < cloud.shown_extra; ++e)
      add_extra(
          i,
          e,
          load_strided<T>(features + row + e, channels()),
          load_strided<T>(g.features + row + e, channels())
      );
  }
};

// sh_rest of ActivateVjp alone, number by number, as a GPU likes to write rows of 45.
struct ShRestVjp {
  ActivateVjp whole;

  GLINT_HD void operator()(std::size_t at) const {
    const std::size_t i = at / 45;
    const int k = static_cast<int>(at % 45 / 3) + 1, c = static_cast<int>(at % 3);
    if (k >= sh_coefficients(whole.degree)) return;
    const float gradient = whole.sum_gradient<float>(i, c);
    if (gradient == 0) return;  // of most surfels: not in view
    float basis[16] = {}, value = 0;
    sh_basis(whole.degree, view_direction<float>(whole.cloud, whole.eye, i).unit, basis);
    unrolled<16>([&](int other) { value = other == k ? basis[other] : value; });
    whole.out.sh_rest[at] += gradient * value;
  }
};

// dL/d(activated) of trace().
struct TracedGradient {
  const float *means, *scales, *rotations, *opacities, *sh_dc, *sh_rest;
};

// Number `at` of every array that has as many, out of 45 a surfel.
struct TraceActivateVjp {
  std::size_t count;                // surfels
  const float *scales, *opacities;  // activated
  TracedGradient g;
  CloudGradientPointers out;  // added to

  GLINT_HD void operator()(std::size_t at) const {
    out.sh_rest[at] += g.sh_rest[at];
    if (at < 4 * count) few(at);
  }

 private:
  GLINT_HD void few(std::size_t at) const {
    out.rotations[at] += g.rotations[at];
    if (at >= 3 * count) return;
    out.means[at] += g.means[at];
    out.sh_dc[at] += g.sh_dc[at];
    if (at >= 2 * count) return;
    out.log_scales[at] += exp_vjp(scales[at], g.scales[at]);
    if (at < count) out.opacity_logits[at] += sigmoid_vjp(opacities[at], g.opacities[at]);
  }
};

using ShadeKernels =
    KernelList<ActivateGeometry, ActivateFeatures, ActivateVjp, ShRestVjp, TraceActivateVjp>;

}  // namespace glint
