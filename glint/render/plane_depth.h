// SPDX-License-Identifier: MIT
// Depth of the plane that a pixel's composited normal and distance describe [Chen24 Eq. 4]: with
// N = sum w n (camera space, towards the camera), Dist = sum w d, d = -n.m of a surfel at m, the
// plane n.p = -d meets the ray r (z = 1) at planar depth D = Dist / -(N.r). What the weights sum to
// cancels, so D is not biased towards the camera where a pixel is not opaque.
#pragma once

#include "glint/core/vec.h"

namespace glint {

inline constexpr float kPlaneDepthEpsilon = 1e-8f;  // published: keeps D finite
// Cosine between ray and plane below which a pixel has no plane depth. Deviation: published are any
// depths, up to 1e8 m and negative; each surfel faces the camera at its centre, but not everywhere.
inline constexpr float kMinPlaneCosine = 1e-3f;

// Whether the plane can be seen at all along `ray`.
template <class T>
GLINT_HD Mask<T> has_plane_depth(T distance, Vec3<T> normal, Vec3<T> ray) {
  const T facing = -dot(normal, ray);
  return (distance > T(0)) &
         (facing > T(kMinPlaneCosine) * length(normal) * length(ray) + T(kPlaneDepthEpsilon));
}

// Planar depth, metres; 0: none.
template <class T>
GLINT_HD T plane_depth(T distance, Vec3<T> normal, Vec3<T> ray) {
  const Mask<T> seen = has_plane_depth(distance, normal, ray);
  const T facing = select(seen, -dot(normal, ray) - T(kPlaneDepthEpsilon), T(1));
  return select(seen, distance / facing, T(0));
}
template <class T>
GLINT_HD void plane_depth_vjp(
    T distance, Vec3<T> normal, Vec3<T> ray, T dL_ddepth, T& dL_ddistance, Vec3<T>& dL_dnormal
) {
  const Mask<T> seen = has_plane_depth(distance, normal, ray);
  const T facing = select(seen, -dot(normal, ray) - T(kPlaneDepthEpsilon), T(1));
  const T slope = select(seen, dL_ddepth / facing, T(0));
  dL_ddistance += slope;
  dL_dnormal += (slope * distance / facing) * ray;
}

}  // namespace glint
