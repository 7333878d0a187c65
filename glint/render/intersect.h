// SPDX-License-Identifier: MIT
// A ray meets a surfel's plane. One text for rasterisation (rays of one camera, the linear form
// below is precomputed per surfel) and tracing (any ray).
//
// A surfel seen from a ray origin is h0 = s_u a, h1 = s_v b (scaled tangents) and m = mu - origin.
// Its plane map H = [h0 h1 m] takes (u, v, 1) to points relative to the origin. For direction d the
// homogeneous solution of H (u, v, 1)^T ~ d is zeta = adj(H) d:
//   zeta = (e1.d, e2.d, e3.d),  e1 = h1 x m,  e2 = m x h0,  e3 = h0 x h1,
//   u = zeta1 / zeta3,  v = zeta2 / zeta3,  t = det(H) / zeta3,  det(H) = m.e3.
// This is [Huang24] Eq. 8-10 with the two pulled-back pixel planes' cross product written out: zeta
// is linear in d, hence affine in the pixel, and t is planar depth for rays with camera z = 1.
#pragma once

#include "glint/core/vec.h"

namespace glint {

// e1, e2, e3 and det of the plane map: all that intersecting needs.
template <class T>
struct PlaneMap {
  Vec3<T> e1, e2, e3;
  T det;
};

template <class T>
GLINT_HD PlaneMap<T> plane_map(Vec3<T> h0, Vec3<T> h1, Vec3<T> m) {
  const Vec3<T> e3 = cross(h0, h1);
  return {cross(h1, m), cross(m, h0), e3, dot(m, e3)};
}
template <class T>
GLINT_HD void plane_map_vjp(
    Vec3<T> h0,
    Vec3<T> h1,
    Vec3<T> m,
    const PlaneMap<T>& dL_dmap,
    Vec3<T>& dL_dh0,
    Vec3<T>& dL_dh1,
    Vec3<T>& dL_dm
) {
  const Vec3<T> e3 = cross(h0, h1);
  const Vec3<T> dL_de3 = dL_dmap.e3 + dL_dmap.det * m;
  dL_dh0 += cross(dL_dmap.e2, m) + cross(h1, dL_de3);
  dL_dh1 += cross(m, dL_dmap.e1) + cross(dL_de3, h0);
  dL_dm += cross(dL_dmap.e1, h1) + cross(h0, dL_dmap.e2) + dL_dmap.det * e3;
}

// zeta and det of one ray, from h0, h1, e3 = h0 x h1, m and its direction d; e1.d and e2.d written
// as triple products with m x d, which costs a third of plane_map().
template <class T>
struct RayPlane {
  Vec3<T> zeta;
  T det;
};
template <class T>
GLINT_HD RayPlane<T> ray_plane(Vec3<T> h0, Vec3<T> h1, Vec3<T> e3, Vec3<T> m, Vec3<T> d) {
  const Vec3<T> c = cross(m, d);
  return {{dot(h1, c), -dot(h0, c), dot(e3, d)}, dot(m, e3)};
}
// Adds to the gradients of h0, h1 (through e3 too), m and d.
template <class T>
GLINT_HD void ray_plane_vjp(
    Vec3<T> h0,
    Vec3<T> h1,
    Vec3<T> e3,
    Vec3<T> m,
    Vec3<T> d,
    const RayPlane<T>& g,
    Vec3<T>& dL_dh0,
    Vec3<T>& dL_dh1,
    Vec3<T>& dL_dm,
    Vec3<T>& dL_dd
) {
  const Vec3<T> c = cross(m, d);
  const Vec3<T> dL_dc = g.zeta.x * h1 - g.zeta.y * h0;
  const Vec3<T> dL_de3 = g.zeta.z * d + g.det * m;
  dL_dh0 += cross(h1, dL_de3) - g.zeta.y * c;
  dL_dh1 += cross(dL_de3, h0) + g.zeta.x * c;
  dL_dm += cross(d, dL_dc) + g.det * e3;
  dL_dd += cross(dL_dc, m) + g.zeta.z * e3;
}

template <class T>
struct PlaneHit {
  T u, v;     // in units of sigma
  T t;        // ray parameter; infinite or NaN for rays in the plane
  T inverse;  // 1 / zeta3
};

template <class T>
GLINT_HD PlaneHit<T> intersect(Vec3<T> zeta, T det) {
  const T inverse = T(1) / zeta.z;
  return {zeta.x * inverse, zeta.y * inverse, det * inverse, inverse};
}
// rho = u^2 + v^2, in units of sigma squared.
template <class T>
GLINT_HD T squared_radius(const PlaneHit<T>& hit) {
  return fma_of(hit.u, hit.u, hit.v * hit.v);
}
// Adds to the gradients of zeta and det. `hit`: what intersect() returned.
template <class T>
GLINT_HD void intersect_vjp(
    const PlaneHit<T>& hit, T dL_du, T dL_dv, T dL_dt, Vec3<T>& dL_dzeta, T& dL_ddet
) {
  dL_dzeta.x += dL_du * hit.inverse;
  dL_dzeta.y += dL_dv * hit.inverse;
  dL_dzeta.z += -(fma_of(dL_du, hit.u, fma_of(dL_dv, hit.v, dL_dt * hit.t)) * hit.inverse);
  dL_ddet += dL_dt * hit.inverse;
}

// Screen-space low-pass [Huang24 Eq. 11]: squared distance in units of sigma = sqrt(2)/2 pixel from
// the centre of the surfel's screen box. The Gaussian's argument is min(rho3, rho2).
template <class T>
GLINT_HD T low_pass_rho2(T dx, T dy) {
  return T(2) * fma_of(dx, dx, dy * dy);
}
template <class T>
GLINT_HD void low_pass_rho2_vjp(T dx, T dy, T dL_drho2, T& dL_ddx, T& dL_ddy) {
  dL_ddx += T(4) * dx * dL_drho2;
  dL_ddy += T(4) * dy * dL_drho2;
}

}  // namespace glint
