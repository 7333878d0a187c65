// SPDX-License-Identifier: MIT
// One triangle: area, normal, distance to a point. In double; vertices are stored as float.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "glint/core/triangle_mesh.h"

namespace glint {

using Corners = std::array<Vec3d, 3>;

inline Corners corners_of(const TriangleMesh& mesh, std::size_t face) {
  Corners corners;
  for (std::size_t k = 0; k < 3; ++k)
    corners[k] = cast<double>(mesh.vertices[static_cast<std::size_t>(mesh.faces[face][k])]);
  return corners;
}

// Normal (right-handed) times twice the area.
inline Vec3d area_vector(const Corners& corners) {
  return cross(corners[1] - corners[0], corners[2] - corners[0]);
}

// Of a point to a segment, which may be a point.
inline double squared_distance(Vec3d point, Vec3d from, Vec3d to) {
  const Vec3d edge = to - from;
  const double length = length2(edge);
  const double t = length > 0 ? std::clamp(dot(point - from, edge) / length, 0.0, 1.0) : 0.0;
  return length2(point - from - t * edge);
}

// Of a point to a triangle; of one without an area, to its edges. With n = ab x ac, the foot of the
// perpendicular is a + s ab + t ac, s = (ap x ac) . n / n.n, t = (ab x ap) . n / n.n. Inside (s, t
// >= 0, s + t <= 1) the plane is nearest, outside an edge.
inline double squared_distance(Vec3d point, const Corners& corners) {
  const Vec3d ab = corners[1] - corners[0], ac = corners[2] - corners[0];
  const Vec3d ap = point - corners[0], n = cross(ab, ac);
  const double nn = length2(n);
  const double s = dot(cross(ap, ac), n), t = dot(cross(ab, ap), n);
  if (nn > 0 && s >= 0 && t >= 0 && s + t <= nn) {
    const double height = dot(ap, n);
    return height * height / nn;
  }
  return std::min(
      {squared_distance(point, corners[0], corners[1]),
       squared_distance(point, corners[1], corners[2]),
       squared_distance(point, corners[2], corners[0])}
  );
}

}  // namespace glint
