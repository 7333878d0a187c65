// SPDX-License-Identifier: MIT
// Meshes in closed form.
#pragma once

#include <cmath>
#include <numbers>

#include "glint/core/triangle_mesh.h"
#include "metrics/mesh/samples.h"

namespace glint::test {

// origin + s u + t v, s and t in [0, 1], in nu x nv cells of two triangles.
inline TriangleMesh parallelogram(Vec3f origin, Vec3f u, Vec3f v, int nu = 1, int nv = 1) {
  TriangleMesh mesh;
  for (int j = 0; j <= nv; ++j)
    for (int i = 0; i <= nu; ++i)
      mesh.vertices.push_back(
          origin + static_cast<float>(i) / static_cast<float>(nu) * u +
          static_cast<float>(j) / static_cast<float>(nv) * v
      );
  for (int j = 0; j < nv; ++j)
    for (int i = 0; i < nu; ++i) {
      const int a = j * (nu + 1) + i, b = a + nu + 1;
      mesh.faces.push_back({a, a + 1, b + 1});
      mesh.faces.push_back({a, b + 1, b});
    }
  return mesh;
}

inline TriangleMesh unit_square(float z) { return parallelogram({0, 0, z}, {1, 0, 0}, {0, 1, 0}); }

inline void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const auto offset = static_cast<std::int32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Triangle& face : other.faces)
    mesh.faces.push_back({face[0] + offset, face[1] + offset, face[2] + offset});
}

// Surface of a cube about `center`, each side in n x n cells. Faces 0 .. 12 n^2 - 1.
inline TriangleMesh cube(Vec3f center, float half, int n = 1) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-half, half}) {
      Vec3f corner = center - Vec3f{half, half, half}, u{}, v{};
      corner[axis] = center[axis] + side;
      u[(axis + 1) % 3] = v[(axis + 2) % 3] = 2 * half;
      append(mesh, parallelogram(corner, u, v, n, n));
    }
  return mesh;
}

// About the origin, vertices on the sphere, at `rings` latitudes and twice as many longitudes.
// Faces at the poles have no area; they are left out.
inline TriangleMesh sphere(double radius, int rings) {
  TriangleMesh mesh;
  const int around = 2 * rings;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < around; ++j) {
      const double latitude = std::numbers::pi * i / rings;
      const double longitude = std::numbers::pi * j / rings;
      mesh.vertices.push_back(cast<float>(
          radius *
          Vec3d{
              std::sin(latitude) * std::cos(longitude),
              std::sin(latitude) * std::sin(longitude),
              std::cos(latitude)}
      ));
    }
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < around; ++j) {
      const int a = i * around + j, b = i * around + (j + 1) % around;
      if (i + 1 < rings) mesh.faces.push_back({a, a + around, b + around});
      if (i > 0) mesh.faces.push_back({a, b + around, b});
    }
  return mesh;
}

}  // namespace glint::test
