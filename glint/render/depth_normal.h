// SPDX-License-Identifier: MIT
// Normal of a depth map by central differences [Huang24 Eq. 15], in camera space, facing the
// camera. Rays are the rasteriser's own (pixel centres at +0.5, true principal point).
#pragma once

#include "glint/core/vec.h"

namespace glint {

// From back-projected neighbours: right - left and down - up. For x right, y down, z forward the
// cross product down x right points towards the camera.
template <class T>
GLINT_HD Vec3<T> normal_from_differences(Vec3<T> right_left, Vec3<T> down_up) {
  const Vec3<T> n = cross(down_up, right_left);
  const T norm = max_of(length(n), T(1e-20f));
  return (T(1) / norm) * n;
}
template <class T>
GLINT_HD void normal_from_differences_vjp(
    Vec3<T> right_left,
    Vec3<T> down_up,
    Vec3<T> dL_dnormal,
    Vec3<T>& dL_dright_left,
    Vec3<T>& dL_ddown_up
) {
  const Vec3<T> n = cross(down_up, right_left);
  const T norm = max_of(length(n), T(1e-20f));
  const Vec3<T> g = normalize_vjp((T(1) / norm) * n, norm, dL_dnormal);
  dL_ddown_up += cross(right_left, g);
  dL_dright_left += cross(g, down_up);
}

// n = N / |N| of a composited normal. A shorter N counts as no normal and gives zero: one surfel
// that counts leaves at least its alpha, 1/255.
inline constexpr float kMinNormalLength = 1e-6f;
template <class T>
GLINT_HD Vec3<T> unit_normal(Vec3<T> composited) {
  const T norm = length(composited);
  const T at_least = max_of(norm, T(kMinNormalLength));
  return select(norm > T(kMinNormalLength), (T(1) / at_least) * composited, Vec3<T>{});
}
template <class T>
GLINT_HD void unit_normal_vjp(Vec3<T> composited, Vec3<T> dL_dunit, Vec3<T>& dL_dcomposited) {
  const T norm = length(composited);
  const T at_least = max_of(norm, T(kMinNormalLength));
  const Vec3<T> g = normalize_vjp(unit_normal(composited), at_least, dL_dunit);
  dL_dcomposited += select(norm > T(kMinNormalLength), g, Vec3<T>{});
}

}  // namespace glint
