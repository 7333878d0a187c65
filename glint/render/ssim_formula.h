// SPDX-License-Identifier: MIT
// SSIM at one pixel [Wang04] with its gradient, and the window. Templates, because the training
// loss (glint/train) and its GPU kernels use the same text.
#pragma once

#include <array>
#include <cmath>
#include <type_traits>

#include "glint/core/real.h"

namespace glint {

inline constexpr int kSsimTaps = 11;
inline constexpr int kSsimRadius = kSsimTaps / 2;
inline constexpr double kSsimSigma = 1.5;                   // pixels
inline constexpr double kSsimC1 = (0.01 * 1) * (0.01 * 1);  // (K1 L)^2, range L = 1
inline constexpr double kSsimC2 = (0.03 * 1) * (0.03 * 1);  // (K2 L)^2

namespace detail {
// A constant at the precision of T's lanes.
template <class T>
GLINT_HD T ssim_constant(double value) {
  if constexpr (std::is_same_v<T, double>) {
    return value;
  } else {
    return T(static_cast<float>(value));
  }
}
}  // namespace detail

// One-dimensional window: exp(-d^2 / (2 sigma^2)) over d = -5..5, divided by its sum. The 11x11
// window is its outer product. Host only; kernels take the array as an argument.
template <class T>
std::array<T, kSsimTaps> ssim_window() {
  std::array<double, kSsimTaps> weights{};
  double sum = 0;
  for (int i = 0; i < kSsimTaps; ++i) {
    const double d = i - kSsimRadius;
    sum += weights[i] = std::exp(-d * d / (2 * kSsimSigma * kSsimSigma));
  }
  std::array<T, kSsimTaps> result{};
  for (int i = 0; i < kSsimTaps; ++i) result[i] = static_cast<T>(weights[i] / sum);
  return result;
}

// [Wang04] Eq. 13 at one pixel from windowed means: mu_x = E[x], mu_y = E[y], xx = E[x^2], yy =
// E[y^2], xy = E[x y], so that variance = xx - mu_x^2 (population). C2 outweighs the rounding of
// float variances (about 1e-7), so slightly negative ones need no clamp.
template <class T>
GLINT_HD T ssim_from_moments(T mu_x, T mu_y, T xx, T yy, T xy) {
  const T c1 = detail::ssim_constant<T>(kSsimC1), c2 = detail::ssim_constant<T>(kSsimC2);
  const T mu_xy = mu_x * mu_y, mu_xx_yy = mu_x * mu_x + mu_y * mu_y;
  const T luminance = T(2) * mu_xy + c1;
  const T structure = T(2) * (xy - mu_xy) + c2;
  return luminance * structure / ((mu_xx_yy + c1) * (xx + yy - mu_xx_yy + c2));
}

// Adds the gradient with respect to the moments of x (the prediction); y is the reference.
template <class T>
GLINT_HD void ssim_from_moments_vjp(
    T mu_x, T mu_y, T xx, T yy, T xy, T dL_dssim, T& dL_dmu_x, T& dL_dxx, T& dL_dxy
) {
  const T c1 = detail::ssim_constant<T>(kSsimC1), c2 = detail::ssim_constant<T>(kSsimC2);
  const T mu_xy = mu_x * mu_y, mu_xx_yy = mu_x * mu_x + mu_y * mu_y;
  const T luminance = T(2) * mu_xy + c1;
  const T structure = T(2) * (xy - mu_xy) + c2;
  const T inv_b1 = T(1) / (mu_xx_yy + c1), inv_b2 = T(1) / (xx + yy - mu_xx_yy + c2);
  const T scale = dL_dssim * inv_b1 * inv_b2;
  const T scaled_ssim = scale * luminance * structure;  // dL_dssim * ssim
  dL_dmu_x +=
      T(2) * (mu_y * scale * (structure - luminance) + mu_x * scaled_ssim * (inv_b2 - inv_b1));
  dL_dxx += -(scaled_ssim * inv_b2);
  dL_dxy += T(2) * scale * luminance;
}

}  // namespace glint
