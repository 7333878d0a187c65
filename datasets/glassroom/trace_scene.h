// SPDX-License-Identifier: MIT
// What the path tracer renders: triangle meshes with materials, area lights. World: metres, z up.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "glint/core/image.h"
#include "glint/core/vec.h"

namespace glint {

// How rough kinds scatter: bsdf.h. A thin dielectric is a sheet without thickness that stands for
// a whole pane: ONE layer of triangles each pane, not a closed slab. A mirror is opaque, perfectly
// smooth and mirrors on both sides.
enum class MaterialKind { kDiffuse, kRoughConductor, kRoughPlastic, kThinDielectric, kMirror };

// As scene.json names them.
constexpr const char* name_of(MaterialKind kind) {
  switch (kind) {
    case MaterialKind::kDiffuse:
      return "diffuse";
    case MaterialKind::kRoughConductor:
      return "rough conductor";
    case MaterialKind::kRoughPlastic:
      return "rough plastic";
    case MaterialKind::kThinDielectric:
      return "thin dielectric";
    case MaterialKind::kMirror:
      return "mirror";
  }
  return "";
}

struct Material {
  std::string name;
  MaterialKind kind = MaterialKind::kDiffuse;
  Vec3f albedo{
      0.5f, 0.5f, 0.5f};   // linear, <= 1; diffuse reflectance, a conductor's F0, a mirror's share
  int texture = -1;        // index into TraceScene::textures; multiplies albedo
  float roughness = 0.3f;  // GGX alpha = roughness^2 of conductor and plastic coat
  float ior = 1.5f;        // thin dielectric, plastic coat
  Vec3f tint{1, 1, 1};     // thin dielectric: transmittance of one pass inside the slab
  Vec3f emission{};        // radiance, linear; > 0: every triangle is an area light, on both sides
};

struct TraceMesh {
  std::string name;
  std::vector<Vec3f> vertices;  // metres, world
  std::vector<Vec3f> normals;   // shading normals per vertex, or empty (flat)
  std::vector<Vec2f> uvs;       // per vertex, or empty; (0, 0) is the first texel's outer corner
  std::vector<std::array<std::int32_t, 3>> faces;
  int material = 0;
};

struct TraceScene {
  std::vector<Material> materials;
  std::vector<Image> textures;  // linear RGB in [0, 1], repeated, bilinear; v grows with the rows
  std::vector<TraceMesh> meshes;
  Vec3f environment{};  // radiance of rays that leave the scene
};

}  // namespace glint
