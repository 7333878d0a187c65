// SPDX-License-Identifier: MIT
// Small vectors and 3x3 matrices over any number type T (float, double, Float8). Column vectors,
// row-major matrices. Unit quaternions are stored (w, x, y, z).
#pragma once

#include "glint/core/real.h"

namespace glint {

template <class T>
struct Vec2 {
  T x{}, y{};
};

template <class T>
struct Vec3 {
  T x{}, y{}, z{};
  GLINT_HD T& operator[](int i) { return i == 0 ? x : (i == 1 ? y : z); }
  GLINT_HD const T& operator[](int i) const { return i == 0 ? x : (i == 1 ? y : z); }
};

template <class T>
struct Vec4 {
  T w{}, x{}, y{}, z{};
};

template <class T>
GLINT_HD Vec2<T> operator+(Vec2<T> a, Vec2<T> b) {
  return {a.x + b.x, a.y + b.y};
}
template <class T>
GLINT_HD Vec2<T> operator-(Vec2<T> a, Vec2<T> b) {
  return {a.x - b.x, a.y - b.y};
}
template <class T>
GLINT_HD Vec2<T> operator*(T s, Vec2<T> a) {
  return {s * a.x, s * a.y};
}

template <class T>
GLINT_HD Vec3<T> operator+(Vec3<T> a, Vec3<T> b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
GLINT_HD Vec3<T> operator-(Vec3<T> a, Vec3<T> b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
GLINT_HD Vec3<T> operator-(Vec3<T> a) {
  return {-a.x, -a.y, -a.z};
}
template <class T>
GLINT_HD Vec3<T> operator*(T s, Vec3<T> a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
GLINT_HD Vec3<T>& operator+=(Vec3<T>& a, Vec3<T> b) {
  return a = a + b;
}
template <class T>
GLINT_HD Vec3<T> hadamard(Vec3<T> a, Vec3<T> b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

template <class T>
GLINT_HD T dot(Vec3<T> a, Vec3<T> b) {
  return fma_of(a.x, b.x, fma_of(a.y, b.y, a.z * b.z));
}
template <class T>
GLINT_HD Vec3<T> cross(Vec3<T> a, Vec3<T> b) {
  return {
      fma_of(a.y, b.z, -(a.z * b.y)),
      fma_of(a.z, b.x, -(a.x * b.z)),
      fma_of(a.x, b.y, -(a.y * b.x))};
}
template <class T>
GLINT_HD T length2(Vec3<T> a) {
  return dot(a, a);
}
template <class T>
GLINT_HD T length(Vec3<T> a) {
  return sqrt_of(dot(a, a));
}
template <class T>
GLINT_HD Vec3<T> normalize(Vec3<T> a) {
  return (T(1) / length(a)) * a;
}

template <class T>
GLINT_HD Vec3<T> select(Mask<T> mask, Vec3<T> a, Vec3<T> b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

// g_a of y = a / |a|, given y, |a| and g_y.
template <class T>
GLINT_HD Vec3<T> normalize_vjp(Vec3<T> unit, T norm, Vec3<T> dL_dunit) {
  return (T(1) / norm) * (dL_dunit - dot(unit, dL_dunit) * unit);
}

template <class T>
struct Mat3 {
  Vec3<T> rows[3];
};
// Of a unit quaternion.
template <class T>
GLINT_HD Mat3<T> rotation_of_unit(Vec4<T> q) {
  const T two(2), one(1);
  return {
      {{one - two * (q.y * q.y + q.z * q.z),
        two * (q.x * q.y - q.w * q.z),
        two * (q.x * q.z + q.w * q.y)},
       {two * (q.x * q.y + q.w * q.z),
        one - two * (q.x * q.x + q.z * q.z),
        two * (q.y * q.z - q.w * q.x)},
       {two * (q.x * q.z - q.w * q.y),
        two * (q.y * q.z + q.w * q.x),
        one - two * (q.x * q.x + q.y * q.y)}}};
}
template <class T>
GLINT_HD Vec3<T> operator*(const Mat3<T>& m, Vec3<T> v) {
  return {dot(m.rows[0], v), dot(m.rows[1], v), dot(m.rows[2], v)};
}
// m^T v
template <class T>
GLINT_HD Vec3<T> transpose_times(const Mat3<T>& m, Vec3<T> v) {
  return v.x * m.rows[0] + v.y * m.rows[1] + v.z * m.rows[2];
}
template <class T>
GLINT_HD Vec3<T> column(const Mat3<T>& m, int i) {
  return {m.rows[0][i], m.rows[1][i], m.rows[2][i]};
}
template <class T>
GLINT_HD Mat3<T> transpose(const Mat3<T>& m) {
  return {{column(m, 0), column(m, 1), column(m, 2)}};
}
template <class T>
GLINT_HD Mat3<T> operator*(const Mat3<T>& a, const Mat3<T>& b) {
  const Mat3<T> bt = transpose(b);
  return {{bt * a.rows[0], bt * a.rows[1], bt * a.rows[2]}};
}
template <class T>
GLINT_HD T determinant(const Mat3<T>& m) {
  return dot(m.rows[0], cross(m.rows[1], m.rows[2]));
}

using Vec2f = Vec2<float>;
using Vec3f = Vec3<float>;
using Vec4f = Vec4<float>;
using Mat3f = Mat3<float>;
using Vec2d = Vec2<double>;
using Vec3d = Vec3<double>;
using Mat3d = Mat3<double>;

template <class T, class S>
GLINT_HD Vec3<T> cast(Vec3<S> v) {
  return {T(v.x), T(v.y), T(v.z)};
}
template <class T, class S>
GLINT_HD Mat3<T> cast(const Mat3<S>& m) {
  return {{cast<T>(m.rows[0]), cast<T>(m.rows[1]), cast<T>(m.rows[2])}};
}

// Element i of an array of three floats each.
GLINT_HD Vec3f get3(const float* array, std::size_t i) {
  return {array[3 * i], array[3 * i + 1], array[3 * i + 2]};
}
GLINT_HD void put3(float* array, std::size_t i, Vec3f v) {
  array[3 * i] = v.x;
  array[3 * i + 1] = v.y;
  array[3 * i + 2] = v.z;
}

}  // namespace glint
