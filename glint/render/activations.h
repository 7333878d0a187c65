// SPDX-License-Identifier: MIT
// From raw parameters to geometry: sigmoid, exp, unit quaternion to rotation, each with its vjp.
#pragma once

#include "glint/core/vec.h"
#include "glint/scene/surfels.h"

namespace glint {

template <class T>
GLINT_HD T sigmoid(T logit) {
  return T(1) / (T(1) + exp_fast(-logit));
}
template <class T>
GLINT_HD T sigmoid_vjp(T value, T dL_dvalue) {
  return dL_dvalue * value * (T(1) - value);
}

template <class T>
GLINT_HD T exp_vjp(T value, T dL_dvalue) {
  return dL_dvalue * value;
}

// tanh x = 2 sigmoid(2 x) - 1.
template <class T>
GLINT_HD T tanh_of(T x) {
  return T(2) * sigmoid(T(2) * x) - T(1);
}
template <class T>
GLINT_HD T tanh_vjp(T value, T dL_dvalue) {
  return dL_dvalue * (T(1) - value * value);
}

// e^min(x, 5), and a fifth of it; no gradient where they are capped.
inline constexpr float kExpCap = 5;
template <class T>
GLINT_HD T exp_to_cap(T x) {
  return exp_fast(min_of(x, T(kExpCap)));
}
template <class T>
GLINT_HD T capped_exp(T x) {
  return T(1 / kExpCap) * exp_to_cap(x);
}
// Of either, from its value.
template <class T>
GLINT_HD T capped_exp_vjp(T x, T value, T dL_dvalue) {
  return keep(x < T(kExpCap), exp_vjp(value, dL_dvalue));
}

// An extra channel of a set, from its raw value x.
template <class T>
GLINT_HD T activated(Activation activation, T x) {
  if (activation == Activation::kTanh) return tanh_of(x);
  return activation == Activation::kCappedExp ? capped_exp(x) : sigmoid(x);
}
template <class T>
GLINT_HD T activated_vjp(Activation activation, T x, T value, T dL_dvalue) {
  if (activation == Activation::kTanh) return tanh_vjp(value, dL_dvalue);
  return activation == Activation::kCappedExp ? capped_exp_vjp(x, value, dL_dvalue)
                                              : sigmoid_vjp(value, dL_dvalue);
}

template <class T>
GLINT_HD T quaternion_norm(Vec4<T> q) {
  return sqrt_of(fma_of(q.w, q.w, fma_of(q.x, q.x, fma_of(q.y, q.y, q.z * q.z))));
}

// Rotation of q / |q|; columns are the surfel's tangents a, b and its normal.
template <class T>
GLINT_HD Mat3<T> rotation_matrix(Vec4<T> raw) {
  const T inverse = T(1) / quaternion_norm(raw);
  return rotation_of_unit(Vec4<T>{
      raw.w * inverse, raw.x * inverse, raw.y * inverse, raw.z * inverse});
}
// g: dL/d(rotation matrix). Through the normalisation: g_raw = (g_q - q (q.g_q)) / |raw|.
template <class T>
GLINT_HD void rotation_matrix_vjp(Vec4<T> raw, const Mat3<T>& g, Vec4<T>& dL_draw) {
  const T inverse = T(1) / quaternion_norm(raw);
  const T w = raw.w * inverse, x = raw.x * inverse, y = raw.y * inverse, z = raw.z * inverse;
  const Vec3<T>* r = g.rows;
  const T two(2);
  const T gw = two * (z * (r[1].x - r[0].y) + y * (r[0].z - r[2].x) + x * (r[2].y - r[1].z));
  const T gx = two * (y * (r[0].y + r[1].x) + z * (r[0].z + r[2].x) + w * (r[2].y - r[1].z) -
                      two * x * (r[1].y + r[2].z));
  const T gy = two * (x * (r[0].y + r[1].x) + z * (r[1].z + r[2].y) + w * (r[0].z - r[2].x) -
                      two * y * (r[0].x + r[2].z));
  const T gz = two * (x * (r[0].z + r[2].x) + y * (r[1].z + r[2].y) + w * (r[1].x - r[0].y) -
                      two * z * (r[0].x + r[1].y));
  const T radial = w * gw + x * gx + y * gy + z * gz;
  dL_draw.w += (gw - w * radial) * inverse;
  dL_draw.x += (gx - x * radial) * inverse;
  dL_draw.y += (gy - y * radial) * inverse;
  dL_draw.z += (gz - z * radial) * inverse;
}

}  // namespace glint
