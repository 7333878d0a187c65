// SPDX-License-Identifier: MIT
// Between linear radiance and sRGB values: the curve [IEC 61966-2-1] and its inverse. Beyond [0, 1]
// they go on, so that no value loses its gradient.
#pragma once

#include "glint/core/vec.h"

namespace glint {

GLINT_HD float pow_of(float x, float y) { return powf(x, y); }
GLINT_HD double pow_of(double x, double y) { return pow(x, y); }

inline constexpr double kSrgbLinearEnd = 0.0031308;
template <class T>
GLINT_HD T srgb_of_linear(T linear) {
  if (linear <= T(kSrgbLinearEnd)) return T(12.92) * linear;
  return T(1.055) * pow_of(linear, T(1 / 2.4)) - T(0.055);
}
template <class T>
GLINT_HD T srgb_of_linear_vjp(T linear, T dL_dsrgb) {
  if (linear <= T(kSrgbLinearEnd)) return T(12.92) * dL_dsrgb;
  return T(1.055 / 2.4) * pow_of(linear, T(1 / 2.4 - 1)) * dL_dsrgb;
}
template <class T>
GLINT_HD T linear_of_srgb(T srgb) {
  if (srgb <= T(12.92 * kSrgbLinearEnd)) return srgb / T(12.92);
  return pow_of((srgb + T(0.055)) / T(1.055), T(2.4));
}
template <class T>
GLINT_HD T linear_of_srgb_vjp(T srgb, T dL_dlinear) {
  if (srgb <= T(12.92 * kSrgbLinearEnd)) return dL_dlinear / T(12.92);
  return T(2.4 / 1.055) * pow_of((srgb + T(0.055)) / T(1.055), T(1.4)) * dL_dlinear;
}

template <class T>
GLINT_HD Vec3<T> srgb_of_linear(Vec3<T> v) {
  return {srgb_of_linear(v.x), srgb_of_linear(v.y), srgb_of_linear(v.z)};
}
template <class T>
GLINT_HD Vec3<T> srgb_of_linear_vjp(Vec3<T> v, Vec3<T> g) {
  return {srgb_of_linear_vjp(v.x, g.x), srgb_of_linear_vjp(v.y, g.y), srgb_of_linear_vjp(v.z, g.z)};
}
template <class T>
GLINT_HD Vec3<T> linear_of_srgb(Vec3<T> v) {
  return {linear_of_srgb(v.x), linear_of_srgb(v.y), linear_of_srgb(v.z)};
}
template <class T>
GLINT_HD Vec3<T> linear_of_srgb_vjp(Vec3<T> v, Vec3<T> g) {
  return {linear_of_srgb_vjp(v.x, g.x), linear_of_srgb_vjp(v.y, g.y), linear_of_srgb_vjp(v.z, g.z)};
}

}  // namespace glint
