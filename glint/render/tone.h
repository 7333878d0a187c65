// SPDX-License-Identifier: MIT
// From linear radiance to values as displayed: sRGB in [0, 1].
#pragma once

#include "glint/core/srgb.h"

namespace glint {

template <class T>
GLINT_HD T displayed(T linear) {
  return min_of(srgb_of_linear(min_of(max_of(linear, T(0)), T(1))), T(1));
}
// No gradient where it is clamped.
template <class T>
GLINT_HD T displayed_vjp(T linear, T dL_ddisplayed) {
  return linear < T(0) || linear > T(1) ? T(0) : srgb_of_linear_vjp(linear, dL_ddisplayed);
}
template <class T>
GLINT_HD Vec3<T> displayed(Vec3<T> linear) {
  return {displayed(linear.x), displayed(linear.y), displayed(linear.z)};
}
template <class T>
GLINT_HD Vec3<T> displayed_vjp(Vec3<T> linear, Vec3<T> g) {
  return {displayed_vjp(linear.x, g.x), displayed_vjp(linear.y, g.y), displayed_vjp(linear.z, g.z)};
}

}  // namespace glint
