// SPDX-License-Identifier: MIT
// View-dependent colour: real spherical harmonics to degree 3, in the order and with the signs of
// 3DGS files [Kerbl23]. colour = max(0, sum_k basis_k(direction) coefficient_k + 0.5).
#pragma once

#include "glint/core/vec.h"
#include "glint/scene/surfels.h"

namespace glint {

GLINT_HD constexpr int sh_coefficients(int degree) { return (degree + 1) * (degree + 1); }

// basis[0 .. (degree+1)^2) for a unit direction.
template <class T>
GLINT_HD void sh_basis(int degree, Vec3<T> d, T basis[16]) {
  const T x = d.x, y = d.y, z = d.z;
  basis[0] = T(kSh0);
  if (degree < 1) return;
  const T c1(0.4886025119029199f);
  basis[1] = -(c1 * y);
  basis[2] = c1 * z;
  basis[3] = -(c1 * x);
  if (degree < 2) return;
  const T xx = x * x, yy = y * y, zz = z * z, c2(1.0925484305920792f);
  basis[4] = c2 * (x * y);
  basis[5] = -(c2 * (y * z));
  basis[6] = T(0.31539156525252005f) * (T(2) * zz - xx - yy);
  basis[7] = -(c2 * (x * z));
  basis[8] = T(0.5462742152960396f) * (xx - yy);
  if (degree < 3) return;
  const T c3(0.5900435899266435f), c4(0.4570457994644658f);
  basis[9] = -(c3 * y * (T(3) * xx - yy));
  basis[10] = T(2.890611442640554f) * (x * y * z);
  basis[11] = -(c4 * y * (T(4) * zz - xx - yy));
  basis[12] = T(0.3731763325901154f) * z * (T(2) * zz - T(3) * (xx + yy));
  basis[13] = -(c4 * x * (T(4) * zz - xx - yy));
  basis[14] = T(1.445305721320277f) * z * (xx - yy);
  basis[15] = -(c3 * x * (xx - T(3) * yy));
}

// Adds to dL/d(direction). The polynomials are differentiated as written, off the unit sphere too;
// the caller projects through its own normalisation.
template <class T>
GLINT_HD void sh_basis_vjp(int degree, Vec3<T> d, const T g[16], Vec3<T>& dL_dd) {
  if (degree < 1) return;
  const T x = d.x, y = d.y, z = d.z;
  const T c1(0.4886025119029199f);
  dL_dd += Vec3<T>{-(c1 * g[3]), -(c1 * g[1]), c1 * g[2]};
  if (degree < 2) return;
  const T xx = x * x, yy = y * y, zz = z * z, c2(1.0925484305920792f);
  const T c20(0.31539156525252005f), c22(0.5462742152960396f), two(2);
  dL_dd.x += c2 * (y * g[4] - z * g[7]) - two * c20 * x * g[6] + two * c22 * x * g[8];
  dL_dd.y += c2 * (x * g[4] - z * g[5]) - two * c20 * y * g[6] - two * c22 * y * g[8];
  dL_dd.z += -(c2 * (y * g[5] + x * g[7])) + T(4) * c20 * z * g[6];
  if (degree < 3) return;
  const T c3(0.5900435899266435f), c4(0.4570457994644658f), c31(2.890611442640554f);
  const T c30(0.3731763325901154f), c32(1.445305721320277f), three(3), four(4), six(6), eight(8);
  dL_dd.x += -(c3 * six * x * y * g[9]) + c31 * y * z * g[10] + two * c4 * x * y * g[11] -
             six * c30 * x * z * g[12] - c4 * (four * zz - three * xx - yy) * g[13] +
             two * c32 * x * z * g[14] - c3 * three * (xx - yy) * g[15];
  dL_dd.y += -(c3 * three * (xx - yy) * g[9]) + c31 * x * z * g[10] -
             c4 * (four * zz - xx - three * yy) * g[11] - six * c30 * y * z * g[12] +
             two * c4 * x * y * g[13] - two * c32 * y * z * g[14] + c3 * six * x * y * g[15];
  dL_dd.z += c31 * x * y * g[10] - eight * c4 * y * z * g[11] +
             c30 * (six * zz - three * (xx + yy)) * g[12] - eight * c4 * x * z * g[13] +
             c32 * (xx - yy) * g[14];
}

// Colour from the SH sum of one channel; negative light is clamped, and then constant.
template <class T>
GLINT_HD T sh_color(T sum) {
  return max_of(sum + T(0.5f), T(0));
}
// From the colour, which is above zero exactly where it is not clamped.
template <class T>
GLINT_HD T clamped_color_vjp(T color, T dL_dcolor) {
  return select(color > T(0), dL_dcolor, T(0));
}
template <class T>
GLINT_HD T sh_color_vjp(T sum, T dL_dcolor) {
  return clamped_color_vjp(sum + T(0.5f), dL_dcolor);
}

}  // namespace glint
