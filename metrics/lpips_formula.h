// SPDX-License-Identifier: MIT
// LPIPS at one pixel of one tap [Zhang18, Eq. 1] with its gradient, and what the networks are fed.
// T: in which sums run; F: of the features.
#pragma once

#include "glint/core/real.h"

namespace glint {

inline constexpr double kLpipsEpsilon = 1e-10;  // added to norms, as the published code does

// The published scaling layer: mean and deviation of the training images in [-1, 1], R G B.
inline constexpr double kLpipsShift[3] = {-0.030, -0.088, -0.188};
inline constexpr double kLpipsScale[3] = {0.458, 0.448, 0.450};

// What is fed for a value in [0, 1], as gain * value + offset.
struct LpipsInput {
  float gain, offset;
};
// `symmetric`: values are first mapped to [-1, 1].
inline LpipsInput lpips_input(bool symmetric, int channel) {
  const double gain = symmetric ? 2 : 1, offset = symmetric ? -1 : 0;
  return {
      static_cast<float>(gain / kLpipsScale[channel]),
      static_cast<float>((offset - kLpipsShift[channel]) / kLpipsScale[channel])};
}

// Euclidean norm over the channels.
template <class T, class F>
GLINT_HD T feature_norm(const F* feature, int channels) {
  T sum = 0;
  for (int c = 0; c < channels; ++c) sum += T(feature[c]) * T(feature[c]);
  return sqrt_of(sum);
}

// Sum over the channels of lin * (a / |a| - b / |b|)^2.
template <class T, class F>
GLINT_HD T lpips_tap(const F* a, const F* b, const F* lin, int channels) {
  const T inv_a = T(1) / (feature_norm<T>(a, channels) + T(kLpipsEpsilon));
  const T inv_b = T(1) / (feature_norm<T>(b, channels) + T(kLpipsEpsilon));
  T sum = 0;
  for (int c = 0; c < channels; ++c) {
    const T difference = T(a[c]) * inv_a - T(b[c]) * inv_b;
    sum += T(lin[c]) * difference * difference;
  }
  return sum;
}

// Adds the gradient with respect to a. Where a is all zero, its norm counts as constant.
template <class T, class F>
GLINT_HD void lpips_tap_vjp(
    const F* a, const F* b, const F* lin, int channels, T dL_dtap, F* dL_da
) {
  const T norm_a = feature_norm<T>(a, channels);
  const T inv_a = T(1) / (norm_a + T(kLpipsEpsilon));
  const T inv_b = T(1) / (feature_norm<T>(b, channels) + T(kLpipsEpsilon));
  const auto dL_dunit = [&](int c) {
    return T(2) * dL_dtap * T(lin[c]) * (T(a[c]) * inv_a - T(b[c]) * inv_b);
  };
  T along_a = 0;
  for (int c = 0; c < channels; ++c) along_a += dL_dunit(c) * T(a[c]);
  const T radial = norm_a > T(0) ? along_a * inv_a * inv_a / norm_a : T(0);
  for (int c = 0; c < channels; ++c)
    dL_da[c] += static_cast<F>(dL_dunit(c) * inv_a - T(a[c]) * radial);
}

}  // namespace glint
