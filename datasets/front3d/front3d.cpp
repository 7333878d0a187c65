// SPDX-License-Identifier: MIT
#include "datasets/front3d/front3d.h"

#include <optional>
#include <set>

#include "datasets/front3d/front3d_scene.h"
#include "datasets/front3d/model_files.h"
#include "datasets/glassroom/make_scene.h"
#include "datasets/glassroom/write_scene.h"
#include "glint/core/error.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"

namespace glint {

namespace {

// Part of every cache key: raise it whenever the same options give other files.
constexpr int kGeneratorVersion = 1;

std::string hash_of_file(const fs::path& file) {
  return fmt::format("{:016x}", hash_name(read_file(file)));
}

std::string hash_of(const Json& hashes) { return fmt::format("{:016x}", hash_name(hashes.dump())); }

// Of the folders of models that the room's furniture names; the rest of 3D-FUTURE does not count.
std::string models_hash(const ChosenRoom& chosen, const std::string& models) {
  if (models.empty()) return {};
  GLINT_CHECK(is_folder(models), kBadReference, "{}: no such folder of models", models);
  std::set<std::string> jids;
  for (const HousePlacement& placement : chosen.room.furniture)
    jids.insert(chosen.house.furniture[placement.furniture].jid);
  Json hashes = Json::object();
  for (const std::string& jid : jids)
    if (find_model(models, jid)) hashes[jid] = hash_of(file_hashes(fs::path(models) / jid));
  return hash_of(hashes);
}

// Of the pictures for kinds of surfaces, and of those that the house's materials name.
std::string textures_hash(const ChosenRoom& chosen, const std::string& textures) {
  if (textures.empty()) return {};
  Json hashes = Json::object();
  for (const fs::path& picture : surface_pictures(textures))
    hashes[picture.filename().string()] = hash_of_file(picture);
  for (const HouseMaterial& material : chosen.house.materials)
    if (const auto picture = find_picture(textures, material.jid))
      hashes[material.jid + "/"] = hash_of_file(*picture);
  return hash_of(hashes);
}

// The options; of files the content counts, not where they lie.
Json spec_json(const ChosenRoom& chosen, const Front3dOptions& options) {
  return {
      {"house", chosen.house.sha256},
      {"room", chosen.room.instanceid},
      {"models", models_hash(chosen, options.models)},
      {"textures", textures_hash(chosen, options.textures)},
      {"width", options.width},
      {"height", options.height},
      {"views", options.views},
      {"spp", options.spp},
      {"seed", options.seed},
      {"priors", options.priors}};
}

std::string key_of(const Json& spec) {
  return hash_of({{"generator", "front3d"}, {"options", spec}, {"version", kGeneratorVersion}});
}

// Of a folder, so without anything that folders or terminals take amiss.
std::string name_of(const ChosenRoom& chosen, const Front3dOptions& options) {
  std::string name = fs::path(options.house).stem().string().substr(0, 40) + "-" +
                     chosen.room.instanceid.substr(0, 60);
  for (char& c : name)
    if (!is_plain_name(std::string_view(&c, 1))) c = '_';
  return name;
}

Json furniture_json(const FurnishedRoom& furnished) {
  Json list = Json::array();
  for (const HousePiece& piece : furnished.pieces)
    list.push_back(
        {{"category", piece.category},
         {"jid", piece.jid},
         {"shape", piece.has_model ? "model" : "box"},
         {"pose", pose_json(piece.pose)},
         {"scale", vector_json(piece.scale)}}
    );
  return list;
}

Json contents_json(const GlassRoomScene& scene) {
  Json list = Json::array();
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    list.push_back({{"name", scene.objects[i]}, {"pose", pose_json(scene.settled.objects[i])}});
  return list;
}

Json more_json(
    const ChosenRoom& chosen, const FurnishedRoom& furnished, const GlassRoomScene& scene
) {
  Json visible = Json::array();
  for (const Camera& camera : scene.cameras)
    visible.push_back(container_visibility(*scene.tracer, scene.container_bounds, camera));
  std::vector<std::string> notes = chosen.house.notes;
  notes.insert(notes.end(), furnished.notes.begin(), furnished.notes.end());
  return {
      {"house",
       {{"sha256", chosen.house.sha256},
        {"uid", chosen.house.uid},
        {"room", chosen.room.instanceid},
        {"room_type", chosen.room.type},
        {"floor_area", floor_area(chosen.house, chosen.room)},
        {"axes", "z up: (x, y, z) of the file is (x, -z, y)"},
        {"origin", vector_json(furnished.origin)},
        {"left_out", notes}}},
      {"furniture", furniture_json(furnished)},
      {"contents", contents_json(scene)},
      {"container_visible", visible}};
}

std::string named(const Front3dOptions& options) {
  return name_of(choose_front3d_room(options), options);
}

std::string hashed(const Front3dOptions& options) {
  return key_of(spec_json(choose_front3d_room(options), options));
}

bool make_room(const Front3dOptions& options, const fs::path& folder, bool again) {
  const ChosenRoom chosen = choose_front3d_room(options);
  const Json spec = spec_json(chosen, options);
  std::optional<FurnishedRoom> furnished;
  const SceneRecipe recipe{
      .name = name_of(chosen, options),
      .dataset = "front3d",
      .title = "3D-FRONT",
      .hash = key_of(spec),
      .version = kGeneratorVersion,
      .options = spec,
      .shots = shots_of(options),
      .render_seed = front3d_render_seed(chosen, options),
      .build =
          [&] {
            furnished.emplace(furnish_front3d_room(chosen, options));
            return build_front3d_scene(*furnished, chosen, options);
          },
      .more = [&](const GlassRoomScene& scene) { return more_json(chosen, *furnished, scene); }};
  return make_scene(recipe, folder, again);
}

}  // namespace

GLINT_PROVIDE(front3d_name, named)
GLINT_PROVIDE(front3d_hash, hashed)
GLINT_PROVIDE(make_front3d, make_room)

}  // namespace glint
