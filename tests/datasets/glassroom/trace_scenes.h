// SPDX-License-Identifier: MIT
// Small scenes with known radiance, for the path tracer's tests.
#pragma once

#include <array>
#include <cmath>
#include <string>

#include "datasets/glassroom/path_tracer.h"
#include "datasets/glassroom/shapes.h"
#include "datasets/glassroom/trace_scene.h"

namespace glint::test {

inline Material diffuse(float albedo) {
  Material m;
  m.name = "diffuse";
  m.albedo = {albedo, albedo, albedo};
  return m;
}
inline Material emitter(float radiance, float albedo = 0) {
  Material m = diffuse(albedo);
  m.name = "emitter";
  m.emission = {radiance, radiance, radiance};
  return m;
}
inline Material glass(float ior, Vec3f tint = {1, 1, 1}) {
  Material m;
  m.name = "glass";
  m.kind = MaterialKind::kThinDielectric;
  m.ior = ior;
  m.tint = tint;
  return m;
}
inline Material glossy(MaterialKind kind, float albedo, float roughness) {
  Material m = diffuse(albedo);
  m.name = "glossy";
  m.kind = kind;
  m.roughness = roughness;
  return m;
}

// Corners in order; uv (0, 0), (1, 0), (1, 1), (0, 1).
inline void add_quad(TraceScene& scene, int material, std::array<Vec3f, 4> corners) {
  TraceMesh mesh;
  mesh.name = "quad" + std::to_string(scene.meshes.size());
  mesh.vertices.assign(corners.begin(), corners.end());
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.faces = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = material;
  scene.meshes.push_back(mesh);
}

// Square of half side `half` at height z.
inline void add_horizontal(TraceScene& scene, int material, float z, float half, float x = 0) {
  add_quad(
      scene,
      material,
      {{{x - half, -half, z}, {x + half, -half, z}, {x + half, half, z}, {x - half, half, z}}}
  );
}

inline void add_box(TraceScene& scene, int material, Vec3f low, Vec3f high) {
  const auto corner = [&](int i) {
    return Vec3f{(i & 1) ? high.x : low.x, (i & 2) ? high.y : low.y, (i & 4) ? high.z : low.z};
  };
  constexpr int kSides[6][4] = {
      {0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  for (const auto& s : kSides)
    add_quad(scene, material, {corner(s[0]), corner(s[1]), corner(s[2]), corner(s[3])});
}

// A wavy floor of 2 cells^2 triangles over [-2.5, 2.5]^2.
inline void add_carpet(TraceScene& scene, int material, int cells) {
  TraceMesh mesh;
  mesh.name = "carpet";
  mesh.material = material;
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= cells; ++j) {
      const float x = 5 * static_cast<float>(i) / static_cast<float>(cells) - 2.5f;
      const float y = 5 * static_cast<float>(j) / static_cast<float>(cells) - 2.5f;
      mesh.vertices.push_back({x, y, 0.05f + 0.02f * std::sin(9 * x) * std::cos(7 * y)});
    }
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      const int v = i * (cells + 1) + j;
      mesh.faces.push_back({v, v + 1, v + cells + 1});
      mesh.faces.push_back({v + 1, v + cells + 2, v + cells + 1});
    }
  scene.meshes.push_back(mesh);
}

// A room with a lamp, a table, a glass box on it, and things of every material inside.
inline TraceScene glass_box_room() {
  TraceScene scene;
  Image checker(8, 8, 3, 0.3f);
  for (int i = 0; i < 64; ++i)
    if ((i + i / 8) % 2 == 0)
      for (int c = 0; c < 3; ++c) checker.at(i % 8, i / 8, c) = 0.7f - 0.1f * static_cast<float>(c);
  scene.textures.push_back(checker);
  Material wall = diffuse(0.9f);
  wall.texture = 0;
  const int walls = add_material(scene, wall);
  const int lamp = add_material(scene, emitter(8));
  const int pane = add_material(scene, glass(1.52f, {0.97f, 0.99f, 0.98f}));
  const int metal = add_material(scene, glossy(MaterialKind::kRoughConductor, 0.8f, 0.4f));
  const int plastic = add_material(scene, glossy(MaterialKind::kRoughPlastic, 0.5f, 0.3f));
  add_box(scene, walls, {-3, -2.5f, 0}, {3, 2.5f, 2.8f});
  add_horizontal(scene, lamp, 2.6f, 0.8f);
  add_box(scene, walls, {-0.7f, -0.7f, 0}, {0.7f, 0.7f, 0.3f});
  add_box(scene, pane, {-0.6f, -0.6f, 0.32f}, {0.6f, 0.6f, 1.3f});
  add_box(scene, metal, {-0.4f, -0.3f, 0.34f}, {-0.1f, 0.1f, 0.8f});
  add_box(scene, plastic, {0.1f, 0.0f, 0.34f}, {0.4f, 0.4f, 0.7f});
  return scene;
}

inline Camera room_camera(ImageSize size) {
  return look_at({2.2, -1.6, 1.5}, {0, 0, 0.8}, {0, 0, 1}, size, 75);
}

// One pixel that sees practically one direction.
inline Camera narrow_camera(Vec3d eye, Vec3d target, int pixels = 1) {
  const Vec3d forward = target - eye;
  const bool vertical = std::abs(forward.x) + std::abs(forward.y) < 1e-6 * std::abs(forward.z);
  return look_at(eye, target, vertical ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1}, {pixels, pixels}, 0.001);
}

// Mean of all values, and the standard error of that mean from the spread over images.
struct MeanAndError {
  double mean = 0, error = 0;
};
inline double mean_of(const Image& image) {
  double sum = 0;
  for (const float value : image.values()) sum += static_cast<double>(value);
  return sum / static_cast<double>(image.values().size());
}
inline MeanAndError mean_over_seeds(
    const PathTracer& tracer, const Camera& camera, PathTracerSettings settings, int seeds
) {
  double sum = 0, sum2 = 0;
  for (int i = 0; i < seeds; ++i) {
    settings.seed = static_cast<std::uint64_t>(1000 + i);
    const double mean = mean_of(tracer.render(camera, settings).radiance);
    sum += mean;
    sum2 += mean * mean;
  }
  const double mean = sum / seeds;
  return {mean, std::sqrt(std::max(0.0, sum2 / seeds - mean * mean) / (seeds - 1))};
}

}  // namespace glint::test
