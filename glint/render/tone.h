// SPDX-License-Identifier: MIT
// From linear radiance to values as displayed: the sRGB curve [IEC 61966-2-1], clamped to [0, 1].
#pragma once

#include "glint/core/vec.h"

namespace glint {

GLINT_HD float pow_of(float x, float y) { return powf(x, y); }
GLINT_HD double pow_of(double x, double y) { return pow(x, y); }

inline constexpr double kSrgbLinearEnd = 0.0031308;
template <class T>
GLINT_HD T displayed(T linear) {
  const T x = min_of(max_of(linear, T(0)), T(1));
  if (x <= T(kSrgbLinearEnd)) return T(12.92) * x;
  return min_of(T(1.055) * pow_of(x, T(1 / 2.4)) - T(0.055), T(1));
}
// No gradient where it is clamped.
template <class T>
GLINT_HD T displayed_vjp(T linear, T dL_ddisplayed) {
  if (linear < T(0) || linear > T(1)) return T(0);
  if (linear <= T(kSrgbLinearEnd)) return T(12.92) * dL_ddisplayed;
  return T(1.055 / 2.4) * pow_of(linear, T(1 / 2.4 - 1)) * dL_ddisplayed;
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
