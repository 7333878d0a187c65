// SPDX-License-Identifier: MIT
// Dissimilarity of two patches, 1 - NCC^2 [Chen24 Eq. 13, as its code has it]: blind to the sign of
// the correlation and to gain and offset of either patch. Sums run over the patch, a, b about any
// fixed values near their means (no cancellation).
#pragma once

#include "glint/core/vec.h"

namespace glint {

inline constexpr int kPatchRadius = 3;  // 7x7 pixels
inline constexpr int kPatchPixels = (2 * kPatchRadius + 1) * (2 * kPatchRadius + 1);
// Published: of the product of both sums of squares.
inline constexpr float kNccEpsilon = 1e-8f;

// Sums over a patch, and those of the derivatives v of its neighbour's values with respect to some
// three parameters: so one pass over the patch gives value and gradient.
template <class T>
struct PatchSums {
  T a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  Vec3<T> v{}, av{}, bv{};

  GLINT_HD void add(T value_a, T value_b, Vec3<T> slope_b) {
    a += value_a;
    b += value_b;
    aa += value_a * value_a;
    bb += value_b * value_b;
    ab += value_a * value_b;
    v += slope_b;
    av += value_a * slope_b;
    bv += value_b * slope_b;
  }
};

template <class T>
struct PatchMoments {
  T mean_a, mean_b, variance_a, variance_b, covariance;  // the last three times kPatchPixels
};
template <class T>
GLINT_HD PatchMoments<T> patch_moments(const PatchSums<T>& sums) {
  const T per_pixel = T(1.0 / kPatchPixels);
  const T mean_a = per_pixel * sums.a, mean_b = per_pixel * sums.b;
  return {
      mean_a,
      mean_b,
      max_of(sums.aa - mean_a * sums.a, T(0)),
      max_of(sums.bb - mean_b * sums.b, T(0)),
      sums.ab - mean_a * sums.b};
}

// In [0, 2]; 1 where a patch is flat.
template <class T>
GLINT_HD T patch_dissimilarity(const PatchSums<T>& sums) {
  const PatchMoments<T> m = patch_moments(sums);
  const T squared = square(m.covariance) / (m.variance_a * m.variance_b + T(kNccEpsilon));
  return min_of(max_of(T(1) - squared, T(0)), T(2));
}
// With respect to the parameters of the slopes. With x = covariance, q = var_a var_b + eps:
// d(1 - x^2 / q)/db_k = -2 x a'_k / q + 2 x^2 var_a b'_k / q^2, a', b' without their means.
template <class T>
GLINT_HD void patch_dissimilarity_vjp(
    const PatchSums<T>& sums, T dL_ddissimilarity, Vec3<T>& dL_dparameters
) {
  const PatchMoments<T> m = patch_moments(sums);
  const T q = m.variance_a * m.variance_b + T(kNccEpsilon);
  const T ratio = m.covariance / q;
  if (!(T(1) - m.covariance * ratio > T(0))) return;  // clamped
  const Vec3<T> centred_av = sums.av - m.mean_a * sums.v, centred_bv = sums.bv - m.mean_b * sums.v;
  dL_dparameters +=
      (T(2) * dL_ddissimilarity * ratio) * ((ratio * m.variance_a) * centred_bv - centred_av);
}

}  // namespace glint
