// SPDX-License-Identifier: MIT
#include "datasets/front3d/surface_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace glint {

namespace {

constexpr float kNoArea = 1e-8f;  // m^2

// Axes of the texture on a surface with this normal.
struct Axes {
  Vec3f u, v;
};
Axes axes_of(Vec3f normal) {
  if (std::abs(normal.z) > 0.7f) return {{1, 0, 0}, {0, -1, 0}};
  return {normalize(cross(Vec3f{0, 0, 1}, normal)), {0, 0, -1}};
}

// Calls f(corners, normal, face) for every triangle that has an area.
template <class F>
void for_each_triangle(const HouseMesh& mesh, Vec3f origin, F&& f) {
  for (const auto& face : mesh.faces) {
    std::array<Vec3f, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = mesh.vertices[static_cast<std::size_t>(face[k])] - origin;
    const Vec3f normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    const float area = 0.5f * length(normal);
    if (area > kNoArea) f(corners, (0.5f / area) * normal, face);
  }
}

void add_triangle(
    TraceMesh& mesh, const std::array<Vec3f, 3>& corners, const std::array<Vec2f, 3>& uvs
) {
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
  mesh.uvs.insert(mesh.uvs.end(), uvs.begin(), uvs.end());
  mesh.faces.push_back({first, first + 1, first + 2});
}

}  // namespace

TraceMesh surface_mesh(const HouseMesh& mesh, Vec3f origin) {
  TraceMesh result;
  for_each_triangle(mesh, origin, [&](const auto& corners, Vec3f normal, const auto&) {
    const Axes axes = axes_of(normal);
    std::array<Vec2f, 3> uvs{};
    for (std::size_t k = 0; k < 3; ++k) uvs[k] = {dot(corners[k], axes.u), dot(corners[k], axes.v)};
    add_triangle(result, corners, uvs);
  });
  return result;
}

TraceMesh own_surface_mesh(const HouseMesh& mesh, const HouseMaterial& material, Vec3f origin) {
  const std::array<float, 6>& m = material.uv_transform;
  TraceMesh result;
  for_each_triangle(mesh, origin, [&](const auto& corners, Vec3f, const auto& face) {
    std::array<Vec2f, 3> uvs{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2f uv = mesh.uvs[static_cast<std::size_t>(face[k])];
      // The file counts v upwards, pictures their rows downwards.
      uvs[k] = {m[0] * uv.x + m[1] * uv.y + m[2], 1 - (m[3] * uv.x + m[4] * uv.y + m[5])};
    }
    add_triangle(result, corners, uvs);
  });
  return result;
}

double area_of(const TraceMesh& mesh) {
  double sum = 0;
  for (const auto& face : mesh.faces) {
    const auto at = [&](std::size_t k) {
      return cast<double>(mesh.vertices[static_cast<std::size_t>(face[k])]);
    };
    sum += 0.5 * length(cross(at(1) - at(0), at(2) - at(0)));
  }
  return sum;
}

float lowest_above(const TraceMesh& mesh, Vec2f p, float above) {
  float lowest = std::numeric_limits<float>::infinity();
  for (const auto& face : mesh.faces) {
    const auto at = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(face[k])]; };
    const Vec3f a = at(0), normal = cross(at(1) - a, at(2) - a);
    if (std::abs(normal.z) < kNoArea) continue;  // seen from its edge
    bool inside = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f from = at(k), to = at((k + 1) % 3);
      const float side = (to.x - from.x) * (p.y - from.y) - (to.y - from.y) * (p.x - from.x);
      inside = inside && side * normal.z >= 0;
    }
    const float z = a.z - (normal.x * (p.x - a.x) + normal.y * (p.y - a.y)) / normal.z;
    if (inside && z > above) lowest = std::min(lowest, z);
  }
  return lowest;
}

}  // namespace glint
