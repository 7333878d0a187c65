// SPDX-License-Identifier: MIT
#include "datasets/glassroom/validate_scene.h"

#include <cmath>

#include "glint/core/error.h"

namespace glint {

namespace {

bool finite(Vec3f v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool within(Vec3f v, float low, float high) {
  return finite(v) && v.x >= low && v.y >= low && v.z >= low && v.x <= high && v.y <= high &&
         v.z <= high;
}
constexpr float kUnbounded = 1e30f;

void check_color(const Material& m, const char* field, Vec3f value, float high) {
  GLINT_CHECK(
      within(value, 0, high),
      kBadReference,
      "material '{}': {} is ({}, {}, {}), expected finite values in [0, {}]",
      m.name,
      field,
      value.x,
      value.y,
      value.z,
      high
  );
}

void check_material(const Material& m, std::size_t num_textures) {
  check_color(m, "albedo", m.albedo, 1);
  check_color(m, "tint", m.tint, 1);
  check_color(m, "emission", m.emission, kUnbounded);
  GLINT_CHECK(
      m.texture >= -1 && m.texture < static_cast<int>(num_textures),
      kBadReference,
      "material '{}': texture {}, but the scene has {}",
      m.name,
      m.texture,
      num_textures
  );
  GLINT_CHECK(
      m.roughness >= 0 && m.roughness <= 1,
      kBadReference,
      "material '{}': roughness {}, expected [0, 1]",
      m.name,
      m.roughness
  );
  GLINT_CHECK(
      m.ior >= 1 && m.ior <= 10,
      kBadReference,
      "material '{}': ior {}, expected [1, 10]",
      m.name,
      m.ior
  );
  const bool emits = m.emission.x > 0 || m.emission.y > 0 || m.emission.z > 0;
  GLINT_CHECK(
      !(emits && (m.kind == MaterialKind::kThinDielectric || m.kind == MaterialKind::kMirror)),
      kBadReference,
      "material '{}': a {} cannot emit; put a light {} it",
      m.name,
      name_of(m.kind),
      m.kind == MaterialKind::kMirror ? "before" : "behind"
  );
}

void check_attribute_count(
    const TraceMesh& mesh, const char* field, std::size_t count, bool may_be_absent
) {
  GLINT_CHECK(
      count == mesh.vertices.size() || (may_be_absent && count == 0),
      kBadReference,
      "mesh '{}': {} {} for {} vertices",
      mesh.name,
      count,
      field,
      mesh.vertices.size()
  );
}

void check_vectors(const TraceMesh& mesh, const char* field, const std::vector<Vec3f>& values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    GLINT_CHECK(
        finite(values[i]), kBadReference, "mesh '{}': {} {} is not finite", mesh.name, field, i
    );
}

void check_faces(const TraceMesh& mesh) {
  const auto count = static_cast<std::int32_t>(mesh.vertices.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (const std::int32_t vertex : mesh.faces[f])
      GLINT_CHECK(
          vertex >= 0 && vertex < count,
          kBadReference,
          "mesh '{}': face {} names vertex {}, but there are {}",
          mesh.name,
          f,
          vertex,
          count
      );
}

void check_mesh(const TraceMesh& mesh, std::size_t num_materials) {
  GLINT_CHECK(
      mesh.material >= 0 && mesh.material < static_cast<int>(num_materials),
      kBadReference,
      "mesh '{}': material {}, but the scene has {}",
      mesh.name,
      mesh.material,
      num_materials
  );
  check_attribute_count(mesh, "normals", mesh.normals.size(), true);
  check_attribute_count(mesh, "uvs", mesh.uvs.size(), true);
  check_vectors(mesh, "vertex", mesh.vertices);
  check_vectors(mesh, "normal", mesh.normals);
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i)
    GLINT_CHECK(
        std::isfinite(mesh.uvs[i].x) && std::isfinite(mesh.uvs[i].y),
        kBadReference,
        "mesh '{}': uv {} is not finite",
        mesh.name,
        i
    );
  check_faces(mesh);
}

void check_texture(const Image& texture, std::size_t index) {
  GLINT_CHECK(
      texture.channels() == 3 && texture.num_pixels() > 0,
      kBadReference,
      "texture {}: {} x {} with {} channels, expected 3 channels (linear RGB)",
      index,
      texture.width(),
      texture.height(),
      texture.channels()
  );
  for (const float value : texture.values())
    GLINT_CHECK(
        value >= 0 && value <= 1,
        kBadReference,
        "texture {}: value {}, expected reflectance in [0, 1]",
        index,
        value
    );
}

}  // namespace

void validate_scene(const TraceScene& scene) {
  for (const Material& material : scene.materials) check_material(material, scene.textures.size());
  for (std::size_t i = 0; i < scene.textures.size(); ++i) check_texture(scene.textures[i], i);
  for (const TraceMesh& mesh : scene.meshes) check_mesh(mesh, scene.materials.size());
  GLINT_CHECK(
      within(scene.environment, 0, kUnbounded),
      kBadReference,
      "environment: ({}, {}, {}), expected finite radiance >= 0",
      scene.environment.x,
      scene.environment.y,
      scene.environment.z
  );
}

}  // namespace glint
