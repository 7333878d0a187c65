// SPDX-License-Identifier: MIT
#include "datasets/glassroom/check_panes.h"

#include <algorithm>
#include <array>
#include <limits>

#include "glint/core/error.h"

namespace glint {

namespace {

using Corners = std::array<Vec3d, 3>;

double clamped(double t) { return std::clamp(t, 0.0, 1.0); }

// Between the segments p + [0, 1] u and q + [0, 1] v, [Ericson05] Sec. 5.1.9.
double segment_distance(Vec3d p, Vec3d u, Vec3d q, Vec3d v) {
  const Vec3d r = p - q;
  const double a = dot(u, u), e = dot(v, v), b = dot(u, v), c = dot(u, r), f = dot(v, r);
  const double denominator = a * e - b * b;
  const double s = denominator > 1e-12 * a * e ? clamped((b * f - c * e) / denominator) : 0;
  const double t = clamped((b * s + f) / e);
  const double back = clamped((b * t - c) / a);  // the nearest to that point
  return length(r + back * u - t * v);
}

// Whether the foot of the perpendicular from `point` lies in the triangle.
bool is_above(const Corners& triangle, Vec3d normal, Vec3d point) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d edge = triangle[(i + 1) % 3] - triangle[i];
    if (dot(cross(edge, point - triangle[i]), normal) < 0) return false;
  }
  return true;
}

// From the edges and corners of `a` to the inside of `b`; infinite where none lies above it.
double distance_to_inside(const Corners& a, const Corners& b) {
  const Vec3d normal = normalize(cross(b[1] - b[0], b[2] - b[0]));
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d from = a[i], to = a[(i + 1) % 3];
    const double h0 = dot(from - b[0], normal), h1 = dot(to - b[0], normal);
    if (is_above(b, normal, from)) nearest = std::min(nearest, std::abs(h0));
    if (h0 * h1 < 0 && is_above(b, normal, from + (h0 / (h0 - h1)) * (to - from))) return 0;
  }
  return nearest;
}

double distance(const Corners& a, const Corners& b) {
  double nearest = std::min(distance_to_inside(a, b), distance_to_inside(b, a));
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      nearest = std::min(
          nearest, segment_distance(a[i], a[(i + 1) % 3] - a[i], b[j], b[(j + 1) % 3] - b[j])
      );
  return nearest;
}

Corners corners_of(const TraceMesh& mesh, std::size_t face) {
  Corners corners;
  for (std::size_t i = 0; i < 3; ++i)
    corners[i] = cast<double>(mesh.vertices[static_cast<std::size_t>(mesh.faces[face][i])]);
  return corners;
}

double distance(const TraceMesh& a, const TraceMesh& b) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < a.faces.size(); ++i)
    for (std::size_t j = 0; j < b.faces.size(); ++j)
      nearest = std::min(nearest, distance(corners_of(a, i), corners_of(b, j)));
  return nearest;
}

bool is_glass(const TraceScene& scene, const TraceMesh& mesh) {
  const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
  return material.kind == MaterialKind::kThinDielectric;
}

}  // namespace

void check_panes(const TraceScene& scene, double gap) {
  for (std::size_t i = 0; i < scene.meshes.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const TraceMesh &a = scene.meshes[j], &b = scene.meshes[i];
      if (!is_glass(scene, a) || !is_glass(scene, b)) continue;
      const double apart = distance(a, b);
      GLINT_CHECK(
          apart >= gap,
          kBadReference,
          "panes '{}' (mesh {}) and '{}' (mesh {}) are {:.2g} mm apart, expected {:g} mm or more: "
          "which of them a ray meets first is left to rounding",
          a.name,
          j,
          b.name,
          i,
          1000 * apart,
          1000 * gap
      );
    }
}

}  // namespace glint
