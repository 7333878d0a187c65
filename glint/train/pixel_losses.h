// SPDX-License-Identifier: MIT
// What losses say about one pixel, each formula with its vjp below it. Loops and sums over an image
// are the losses' own (*_kernels.h).
#pragma once

#include <cmath>

#include "glint/core/vec.h"
#include "glint/render/depth_normal.h"

namespace glint {

// The slope of |a|, 0 at 0. Without a branch, which would be taken at random.
GLINT_HD float sign_of(float a) { return static_cast<float>(int(a > 0) - int(a < 0)); }
GLINT_HD double sign_of(double a) { return static_cast<double>(int(a > 0) - int(a < 0)); }
template <class T>
GLINT_HD T l1_norm(Vec3<T> a) {
  return abs_of(a.x) + abs_of(a.y) + abs_of(a.z);
}

// 1 - <n, prior> + l1 |n - prior|_1, or 0 where the cosine is below the gate. The gate is a
// constant: no gradient.
template <class T>
GLINT_HD T gated_normal_loss(Vec3<T> unit, Vec3<T> prior, T min_cosine, T l1) {
  const T cosine = dot(unit, prior);
  return keep(cosine >= min_cosine, T(1) - cosine + l1 * l1_norm(unit - prior));
}
template <class T>
GLINT_HD void gated_normal_loss_vjp(
    Vec3<T> unit, Vec3<T> prior, T min_cosine, T l1, T dL_dloss, Vec3<T>& dL_dunit
) {
  const Vec3<T> off = unit - prior;
  const Vec3<T> slope = Vec3<T>{sign_of(off.x), sign_of(off.y), sign_of(off.z)};
  dL_dunit += keep(dot(unit, prior) >= min_cosine, dL_dloss) * (l1 * slope - prior);
}

// exp(-sharpness mean_c |a_c - b_c|) of two neighbours' colours: small across an image edge.
template <class T>
GLINT_HD T edge_weight(Vec3<T> a, Vec3<T> b, T sharpness) {
  return exp_fast(-sharpness * T(1.0 / 3) * l1_norm(a - b));
}

// Probabilities are kept this far from 0 and 1; beyond, a loss is constant.
inline constexpr float kMinProbability = 1e-6f;
template <class T>
GLINT_HD T clamped_probability(T p) {
  return min_of(max_of(p, T(kMinProbability)), T(1) - T(kMinProbability));
}

// -target log p - (1 - target) log(1 - p).
template <class T>
GLINT_HD T binary_cross_entropy(T p, T target) {
  const T q = clamped_probability(p);
  return -target * log_of(q) - (T(1) - target) * log_of(T(1) - q);
}
template <class T>
GLINT_HD void binary_cross_entropy_vjp(T p, T target, T dL_dloss, T& dL_dp) {
  const T q = clamped_probability(p);
  dL_dp += keep(q == p, dL_dloss * (q - target) / (q * (T(1) - q)));
}

// -p log p - (1 - p) log(1 - p).
template <class T>
GLINT_HD T binary_entropy(T p) {
  return binary_cross_entropy(p, clamped_probability(p));
}
template <class T>
GLINT_HD void binary_entropy_vjp(T p, T dL_dloss, T& dL_dp) {
  const T q = clamped_probability(p);
  dL_dp += keep(q == p, dL_dloss * (log_of(T(1) - q) - log_of(q)));
}

}  // namespace glint
