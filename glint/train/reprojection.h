// SPDX-License-Identifier: MIT
// Forward and backward reprojection [Chen24 Eq. 12]: a pixel of the reference view is lifted by its
// depth, seen from the neighbour, moved there to the neighbour's depth, and seen from the reference
// again. How far it lands from where it started says how much both depth maps disagree.
#pragma once

#include "glint/render/pinhole.h"

namespace glint {

// in_neighbor: the lifted point in the neighbour's camera; depth: the neighbour's planar depth
// there, metres. Image point in the reference.
template <class T>
GLINT_HD Vec3<T> moved_to_depth(const CameraPair<T>& pair, Vec3<T> in_neighbor, T depth) {
  return pair.to_reference((depth / in_neighbor.z) * in_neighbor);
}
template <class T>
GLINT_HD void moved_to_depth_vjp(
    const CameraPair<T>& pair,
    Vec3<T> in_neighbor,
    T depth,
    Vec3<T> dL_din_reference,
    Vec3<T>& dL_din_neighbor,
    T& dL_ddepth
) {
  const Vec3<T> g = pair.rotation * dL_din_reference;
  const Vec3<T> ray = (T(1) / in_neighbor.z) * in_neighbor;
  const T along = dot(g, ray);
  dL_ddepth += along;
  const T scale = depth / in_neighbor.z;
  dL_din_neighbor += Vec3<T>{scale * g.x, scale * g.y, scale * (g.z - along)};
}

// Distance of two image points, pixels. Its gradient is zero where they are one.
template <class T>
GLINT_HD T pixel_distance(Vec2<T> a, Vec2<T> b) {
  return sqrt_of(square(a.x - b.x) + square(a.y - b.y));
}
template <class T>
GLINT_HD void pixel_distance_vjp(Vec2<T> a, Vec2<T> b, T dL_ddistance, Vec2<T>& dL_da) {
  const T distance = pixel_distance(a, b);
  const T scale = distance > T(1e-8f) ? dL_ddistance / distance : T(0);
  dL_da = dL_da + scale * (a - b);
}

}  // namespace glint
