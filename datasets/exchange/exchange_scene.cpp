// SPDX-License-Identifier: MIT
#include "datasets/exchange/exchange_scene.h"

#include "datasets/exchange/exchange_mesh.h"
#include "datasets/glassroom/bsdf.h"
#include "datasets/glassroom/validate_scene.h"
#include "glint/core/error.h"
#include "glint/core/left_behind.h"
#include "glint/core/presence.h"
#include "glint/scene/image_files.h"

namespace glint {

namespace {

constexpr const char* kFormat = "glint exchange scene";
constexpr int kVersion = 1;
// A colour ramp of Blender has room for 32 colours.
constexpr int kAlbedoSteps = 31;

template <class T>
Json vector_json(Vec3<T> v) {
  return {v.x, v.y, v.z};
}

std::string texture_file(int texture) { return fmt::format("textures/{}.exr", texture); }

const char* kind_name(MaterialKind kind) {
  constexpr const char* kNames[] = {"diffuse", "conductor", "plastic", "thin dielectric", "mirror"};
  return kNames[static_cast<int>(kind)];
}

// Share of white light from one direction that the plastic's coat mirrors, at cosines
// (i / kAlbedoSteps)^2. Its base gets the rest.
Json coat_albedo(const path_tracing::MaterialModel& model) {
  Json values = Json::array();
  for (int i = 0; i <= kAlbedoSteps; ++i) {
    const float root = static_cast<float>(i) / kAlbedoSteps;
    values.push_back(model.albedo_table(root * root));
  }
  return values;
}

Json material_json(const Material& m, std::size_t index) {
  Json json{
      {"id", exchange_material_id(index)},
      {"name", m.name},
      {"kind", kind_name(m.kind)},
      {"albedo", vector_json(m.albedo)},
      {"emission", vector_json(m.emission)}};
  if (m.texture >= 0) json["texture"] = texture_file(m.texture);
  if (m.kind == MaterialKind::kThinDielectric) {
    json["ior"] = m.ior;
    json["tint"] = vector_json(m.tint);
  } else if (m.kind != MaterialKind::kDiffuse && m.kind != MaterialKind::kMirror) {
    const path_tracing::MaterialModel model = path_tracing::prepare_material(m);
    json["roughness"] = m.roughness;
    json["alpha"] = model.alpha;
    if (m.kind == MaterialKind::kRoughPlastic) {
      json["ior"] = m.ior;
      json["coat_albedo"] = coat_albedo(model);
    }
  }
  return json;
}

Json view_json(const ExchangeView& view) {
  const Camera& c = view.camera;
  Json rows = Json::array();
  for (const Vec3d& row : c.rotation_cam_from_world.rows) rows.push_back(vector_json(row));
  return {
      {"name", view.name},
      {"test", view.is_test},
      {"width", c.width},
      {"height", c.height},
      {"fx", c.fx},
      {"fy", c.fy},
      {"cx", c.cx},
      {"cy", c.cy},
      {"rotation_cam_from_world", rows},
      {"translation_cam_from_world", vector_json(c.translation_cam_from_world)}};
}

Json scene_json(const ExchangeScene& exchange) {
  Json materials = Json::array(), views = Json::array();
  for (std::size_t i = 0; i < exchange.scene.materials.size(); ++i)
    materials.push_back(material_json(exchange.scene.materials[i], i));
  for (const ExchangeView& view : exchange.views) views.push_back(view_json(view));
  return {
      {"format", kFormat},
      {"version", kVersion},
      {"name", exchange.name},
      {"origin", exchange.origin},
      {"unit", "metre"},
      {"up", "z"},
      {"camera_axes", "x right, y down, z forward; pixel centres at +0.5"},
      {"radiance", "linear Rec. 709; W / (sr m^2) where emission is in it"},
      {"exposure", exchange.exposure},
      {"environment", vector_json(exchange.scene.environment)},
      {"meshes", "meshes.obj"},
      {"texture_encoding", "linear, float32; bilinear, repeated"},
      {"materials", materials},
      {"views", views}};
}

void write(const ExchangeScene& exchange, const fs::path& folder) {
  std::error_code code;
  GLINT_CHECK(
      !is_there(folder) || fs::is_empty(folder, code),
      kUsage,
      "{}: is there already; remove it or choose another folder",
      folder.string()
  );
  validate_scene(exchange.scene);
  const UnfinishedFolder unfinished(folder);
  write_file(unfinished.path() / "meshes.obj", exchange_meshes(exchange.scene));
  for (std::size_t i = 0; i < exchange.scene.textures.size(); ++i)
    write_exr(unfinished.path() / texture_file(static_cast<int>(i)), exchange.scene.textures[i]);
  write_file(unfinished.path() / "exchange.json", scene_json(exchange).dump(1) + "\n");
  fs::remove(folder, code);
  fs::rename(unfinished.path(), folder, code);
  GLINT_CHECK(!code, kEnvironment, "{}: cannot be written ({})", folder.string(), code.message());
}

}  // namespace

GLINT_PROVIDE(write_exchange_scene, write)

}  // namespace glint
