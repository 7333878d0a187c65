// SPDX-License-Identifier: MIT
#include "datasets/glassroom/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "glint/core/error.h"

namespace glint {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

void add_vertex(TraceMesh& mesh, Vec3f position, Vec3f normal, Vec2f uv) {
  mesh.vertices.push_back(position);
  mesh.normals.push_back(normal);
  mesh.uvs.push_back(uv);
}

// Two triangles over vertices a b c d (counter-clockwise seen from outside).
void add_cell(TraceMesh& mesh, int a, int b, int c, int d) {
  mesh.faces.push_back({a, b, c});
  mesh.faces.push_back({a, c, d});
}

// Planar quadrilateral with corners counter-clockwise seen from outside; uv along its first edge.
void add_planar(TraceMesh& mesh, const std::array<Vec3f, 4>& corners) {
  const Vec3f u = normalize(corners[1] - corners[0]);
  const Vec3f normal = normalize(cross(corners[1] - corners[0], corners[3] - corners[0]));
  const Vec3f v = cross(normal, u);
  const int first = static_cast<int>(mesh.vertices.size());
  for (const Vec3f corner : corners) {
    const Vec3f offset = corner - corners[0];
    add_vertex(mesh, corner, normal, {dot(offset, u), dot(offset, v)});
  }
  add_cell(mesh, first, first + 1, first + 2, first + 3);
}

// Rectangle of half sizes (x, y) at height z with corners cut by `cut`: eight points from above.
std::array<Vec3f, 8> octagon(Vec3f center, float x, float y, float cut, float z) {
  const auto at = [&](float dx, float dy) { return Vec3f{center.x + dx, center.y + dy, z}; };
  return {
      at(x - cut, -y),
      at(x, -y + cut),
      at(x, y - cut),
      at(x - cut, y),
      at(-x + cut, y),
      at(-x, y - cut),
      at(-x, -y + cut),
      at(-x + cut, -y)};
}

}  // namespace

Pose translated(Vec3f translation) { return {.translation = translation}; }

Pose yawed(float yaw, Vec3f translation) {
  const float c = std::cos(yaw), s = std::sin(yaw);
  return {.rotation = {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}}, .translation = translation};
}

Pose compose(const Pose& outer, const Pose& inner) {
  return {
      .rotation = outer.rotation * inner.rotation, .translation = outer.apply(inner.translation)};
}

void Bounds::include(Vec3f point) {
  for (int i = 0; i < 3; ++i) {
    low[i] = std::min(low[i], point[i]);
    high[i] = std::max(high[i], point[i]);
  }
}

Bounds Bounds::grown(float margin) const {
  const Vec3f d{margin, margin, margin};
  return {.low = low - d, .high = high + d};
}

bool Bounds::contains(Vec3f p) const {
  return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z &&
         p.z <= high.z;
}

bool Bounds::contains(const Bounds& other) const {
  return contains(other.low) && contains(other.high);
}

bool Bounds::overlaps(const Bounds& other) const {
  for (int i = 0; i < 3; ++i)
    if (low[i] >= other.high[i] || high[i] <= other.low[i]) return false;
  return true;
}

Bounds bounds_of(const TraceMesh& mesh) {
  Bounds bounds;
  for (const Vec3f vertex : mesh.vertices) bounds.include(vertex);
  return bounds;
}

TraceMesh box_mesh(Vec3f a, Vec3f b) {
  TraceMesh mesh;
  add_planar(mesh, {Vec3f{a.x, a.y, a.z}, {b.x, a.y, a.z}, {b.x, a.y, b.z}, {a.x, a.y, b.z}});
  add_planar(mesh, {Vec3f{b.x, b.y, a.z}, {a.x, b.y, a.z}, {a.x, b.y, b.z}, {b.x, b.y, b.z}});
  add_planar(mesh, {Vec3f{a.x, b.y, a.z}, {a.x, a.y, a.z}, {a.x, a.y, b.z}, {a.x, b.y, b.z}});
  add_planar(mesh, {Vec3f{b.x, a.y, a.z}, {b.x, b.y, a.z}, {b.x, b.y, b.z}, {b.x, a.y, b.z}});
  add_planar(mesh, {Vec3f{a.x, a.y, b.z}, {b.x, a.y, b.z}, {b.x, b.y, b.z}, {a.x, b.y, b.z}});
  add_planar(mesh, {Vec3f{a.x, b.y, a.z}, {b.x, b.y, a.z}, {b.x, a.y, a.z}, {a.x, a.y, a.z}});
  return mesh;
}

TraceMesh cushion_mesh(Vec3f low, Vec3f high, float bevel) {
  const Vec3f half = 0.5f * (high - low), center = 0.5f * (low + high);
  const float cut = std::min({bevel, 0.9f * half.x, 0.9f * half.y, 1.8f * half.z});
  const auto bottom = octagon(center, half.x, half.y, cut, low.z);
  const auto side = octagon(center, half.x, half.y, cut, high.z - cut);
  const auto top = octagon(center, half.x - cut, half.y - cut, 0.4f * cut, high.z);
  TraceMesh mesh;
  for (std::size_t i = 0; i < 8; ++i) {
    const std::size_t j = (i + 1) % 8;
    add_planar(mesh, {bottom[i], bottom[j], side[j], side[i]});
    add_planar(mesh, {side[i], side[j], top[j], top[i]});
  }
  for (const auto& ring : {top, bottom}) {
    const bool up = ring[0].z > center.z;
    const int first = static_cast<int>(mesh.vertices.size());
    for (const Vec3f p : ring) add_vertex(mesh, p, {0, 0, up ? 1.0f : -1.0f}, {p.x, p.y});
    for (int i = 1; i < 7; ++i)
      mesh.faces.push_back(
          up ? std::array{first, first + i, first + i + 1}
             : std::array{first, first + i + 1, first + i}
      );
  }
  return mesh;
}

TraceMesh quad_mesh(Vec3f origin, Vec3f u, Vec3f v) {
  TraceMesh mesh;
  add_planar(mesh, {origin, origin + u, origin + u + v, origin + v});
  return mesh;
}

TraceMesh lathe_mesh(std::span<const Vec2f> profile, int segments) {
  GLINT_CHECK(profile.size() >= 2, kUsage, "lathe_mesh: {} profile points", profile.size());
  TraceMesh mesh;
  float along = 0;
  // Each profile segment has its own two rings, so that its edges stay sharp and its normals exact.
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    const Vec2f a = profile[i], b = profile[i + 1];
    const float dr = b.x - a.x, dz = b.y - a.y, slant = std::hypot(dr, dz);
    if (slant < 1e-6f) continue;
    const int first = static_cast<int>(mesh.vertices.size());
    for (int s = 0; s <= segments; ++s) {
      const float angle = 2 * kPi * static_cast<float>(s) / static_cast<float>(segments);
      const float c = std::cos(angle), d = std::sin(angle), u = angle * std::max(a.x, b.x);
      const Vec3f normal{c * dz / slant, d * dz / slant, -dr / slant};
      add_vertex(mesh, {a.x * c, a.x * d, a.y}, normal, {u, along});
      add_vertex(mesh, {b.x * c, b.x * d, b.y}, normal, {u, along + slant});
    }
    for (int s = 0; s < segments; ++s) {
      const int k = first + 2 * s;
      if (a.x > 0) mesh.faces.push_back({k, k + 2, k + 1});
      if (b.x > 0) mesh.faces.push_back({k + 2, k + 3, k + 1});
    }
    along += slant;
  }
  return mesh;
}

TraceMesh sphere_mesh(float radius, int segments) {
  std::vector<Vec2f> profile;
  const int rings = segments / 2;
  for (int i = 0; i <= rings; ++i) {
    const float angle = kPi * (static_cast<float>(i) / static_cast<float>(rings) - 0.5f);
    const bool pole = i == 0 || i == rings;
    profile.push_back({pole ? 0 : radius * std::cos(angle), radius * std::sin(angle)});
  }
  TraceMesh mesh = lathe_mesh(profile, segments);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    mesh.normals[i] = (1 / radius) * mesh.vertices[i];
  return mesh;
}

TraceMesh cylinder_mesh(float radius, float height, int segments) {
  return lathe_mesh(
      std::array<Vec2f, 4>{Vec2f{0, 0}, {radius, 0}, {radius, height}, {0, height}}, segments
  );
}

TraceMesh cone_mesh(float radius, float height, int segments) {
  return lathe_mesh(std::array<Vec2f, 3>{Vec2f{0, 0}, {radius, 0}, {0, height}}, segments);
}

TraceMesh torus_mesh(float ring_radius, float tube_radius, int segments, int sides) {
  TraceMesh mesh;
  for (int i = 0; i <= segments; ++i)
    for (int j = 0; j <= sides; ++j) {
      const float a = 2 * kPi * static_cast<float>(i) / static_cast<float>(segments);
      const float b = 2 * kPi * static_cast<float>(j) / static_cast<float>(sides);
      const Vec3f normal{std::cos(b) * std::cos(a), std::cos(b) * std::sin(a), std::sin(b)};
      const Vec3f ring{ring_radius * std::cos(a), ring_radius * std::sin(a), 0};
      add_vertex(mesh, ring + tube_radius * normal, normal, {a * ring_radius, b * tube_radius});
    }
  for (int i = 0; i < segments; ++i)
    for (int j = 0; j < sides; ++j) {
      const int k = i * (sides + 1) + j;
      add_cell(mesh, k, k + sides + 1, k + sides + 2, k + 1);
    }
  return mesh;
}

TraceMesh tube_mesh(std::span<const Vec3f> path, std::span<const float> radii, int sides) {
  GLINT_CHECK(path.size() >= 2 && radii.size() == path.size(), kUsage, "tube_mesh: bad path");
  TraceMesh mesh;
  const std::size_t n = path.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3f tangent = normalize(path[std::min(i + 1, n - 1)] - path[i > 0 ? i - 1 : 0]);
    const Vec3f helper = std::abs(tangent.y) < 0.9f ? Vec3f{0, 1, 0} : Vec3f{1, 0, 0};
    const Vec3f u = normalize(cross(helper, tangent)), v = cross(tangent, u);
    for (int j = 0; j <= sides; ++j) {
      const float a = 2 * kPi * static_cast<float>(j) / static_cast<float>(sides);
      const Vec3f normal = std::cos(a) * u + std::sin(a) * v;
      add_vertex(mesh, path[i] + radii[i] * normal, normal, {a * radii[i], static_cast<float>(i)});
    }
  }
  for (int i = 0; i + 1 < static_cast<int>(n); ++i)
    for (int j = 0; j < sides; ++j) {
      const int k = i * (sides + 1) + j;
      add_cell(mesh, k, k + 1, k + sides + 2, k + sides + 1);
    }
  return mesh;
}

TraceMesh curtain_mesh(float width, float height, int folds, float depth) {
  TraceMesh mesh;
  const int columns = 8 * folds;
  for (int i = 0; i <= columns; ++i) {
    const float s = static_cast<float>(i) / static_cast<float>(columns);
    const float phase = 2 * kPi * s * static_cast<float>(folds);
    const float slope = depth * kPi * static_cast<float>(folds) / width * std::cos(phase);
    const Vec3f normal = normalize(Vec3f{-slope, 1, 0});
    const Vec3f bottom{(s - 0.5f) * width, 0.5f * depth * (1 + std::sin(phase)), 0};
    add_vertex(mesh, bottom, normal, {s * width, 0});
    add_vertex(mesh, bottom + Vec3f{0, 0, height}, normal, {s * width, height});
  }
  for (int i = 0; i < columns; ++i) add_cell(mesh, 2 * i + 2, 2 * i, 2 * i + 1, 2 * i + 3);
  return mesh;
}

void transform(TraceMesh& mesh, const Pose& pose) {
  for (Vec3f& vertex : mesh.vertices) vertex = pose.apply(vertex);
  for (Vec3f& normal : mesh.normals) normal = pose.rotation * normal;
}

void append(TraceMesh& mesh, const TraceMesh& part, const Pose& pose) {
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  for (std::size_t i = 0; i < part.vertices.size(); ++i)
    add_vertex(mesh, pose.apply(part.vertices[i]), pose.rotation * part.normals[i], part.uvs[i]);
  for (const auto& f : part.faces) mesh.faces.push_back({first + f[0], first + f[1], first + f[2]});
}

void scale_uvs(TraceMesh& mesh, float factor, Vec2f offset) {
  for (Vec2f& uv : mesh.uvs) uv = factor * uv + offset;
}

int add_texture(TraceScene& scene, Image texture) {
  scene.textures.push_back(std::move(texture));
  return static_cast<int>(scene.textures.size()) - 1;
}

int add_material(TraceScene& scene, Material material) {
  scene.materials.push_back(std::move(material));
  return static_cast<int>(scene.materials.size()) - 1;
}

void add_mesh(TraceScene& scene, TraceMesh mesh, std::string name, int material) {
  mesh.name = std::move(name);
  mesh.material = material;
  scene.meshes.push_back(std::move(mesh));
}

}  // namespace glint
