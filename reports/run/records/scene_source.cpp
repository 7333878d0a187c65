// SPDX-License-Identifier: MIT
#include "reports/run/records/scene_source.h"

#include <utility>

#include "datasets/dataset.h"
#include "datasets/glassroom/glassroom.h"
#include "datasets/released_truth.h"
#include "glint/core/file_lock.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "glint/core/sha256.h"
#include "reports/run/records/code_hashes.h"
#include "reports/run/records/manifest.h"
#include "reports/run/records/stage_files.h"

namespace glint {

namespace {

GlassRoomOptions glassroom_options(const SceneSource& source) {
  GlassRoomOptions options;
  options.scene = source.room.empty() ? source.scene : source.room;
  options.width = source.width;
  options.height = source.height;
  options.views = source.views;
  options.spp = source.spp;
  options.seed = source.seed;
  options.assets = source.assets;
  options.priors = source.priors;
  return options;
}

// Named by its options alone: what other code makes of them takes its place.
fs::path made_folder(const SceneSource& source, const fs::path& data_folder) {
  const GlassRoomOptions options = glassroom_options(source);
  const std::string hash = glassroom_hash(options).substr(0, 8);
  return data_folder / source.dataset / fmt::format("{}-{}", options.scene, hash);
}

fs::path folder_of(const SceneSource& source, const fs::path& data_folder) {
  if (source.made()) return made_folder(source, data_folder);
  const Manifest* manifest = find_manifest(source.manifest);
  if (manifest == nullptr) return data_folder / source.folder;
  return manifest_scene_folder(*manifest, {source.scene, source.folder}, data_folder);
}

// The options with their folder as load_scene() takes it.
PriorOptions placed_priors(PriorOptions priors, const fs::path& data_folder) {
  if (!priors.folder.empty()) priors.folder = (data_folder / priors.folder).string();
  return priors;
}

fs::path hash_cache(const fs::path& data_folder) { return data_folder / ".hashes"; }

Json make_document(const SceneSource& source) {
  return {{"scene", glassroom_json(glassroom_options(source))}, {"code", code_json({"make"})}};
}

// Empty: the folder holds what this program would make.
std::string why_make(const SceneSource& source, const fs::path& folder) {
  if (!is_there(folder)) return "not made yet";
  const auto made = read_stage(folder, Stage::kData);
  if (!made) return "made by an earlier version, without a key, or not to the end";
  const auto differences = stage_differences(made->document, make_document(source));
  return differences.empty() ? what_is_damaged(folder, *made) : differences.front();
}

// GlassRoom lists the hashes of what it made.
std::string made_content(const fs::path& folder) {
  const Json description = read_json_object(folder / "scene.json");
  return sha256(description.value("files", Json::object()).dump());
}

Json load_code(const fs::path& folder, const std::string& loader) {
  return code_json({"load", code_entry_of(find_loader(folder, loader).source)});
}

// How pictures and priors are read besides max_pixels. Only what is not as always, so that earlier
// keys go on. Of a folder of priors the place below --data and the content.
void add_reading(const LoadOptions& options, const fs::path& data_folder, Json& scene) {
  const PriorOptions& priors = options.priors;
  if (options.image_ratio != 1) scene["image_ratio"] = options.image_ratio;
  if (!priors.axes.empty()) scene["prior_axes"] = priors.axes;
  if (!priors.depth.empty()) scene["prior_depth"] = priors.depth;
  if (priors.overlap >= 0) scene["prior_overlap"] = priors.overlap;
  if (priors.albedo_from_basecolor) scene["albedo_from_basecolor"] = true;
  if (!priors.folder.empty())
    scene["prior_folder"] = {
        priors.folder,
        content_hash(placed_priors(priors, data_folder).folder, hash_cache(data_folder))};
}

PriorOptions priors_of(const Json& scene) {
  return {
      scene.contains("prior_folder") ? scene["prior_folder"].at(0).get<std::string>() : "",
      scene.value("prior_axes", ""),
      scene.value("prior_depth", ""),
      scene.value("prior_overlap", -1),
      scene.value("albedo_from_basecolor", false)};
}

// Folders of priors as of the source.
LoadOptions options_of(const SceneSource& source) {
  LoadOptions options;
  options.max_pixels = source.max_pixels;
  options.image_ratio = source.image_ratio;
  options.loader = source.loader;
  options.priors = source.foreign_priors;
  return options;
}

// `scene`: what data_document() made of them.
LoadOptions options_of(const Json& scene, const std::string& loader) {
  LoadOptions options;
  options.max_pixels = scene.at("max_pixels");
  options.image_ratio = scene.value("image_ratio", 1.0);
  options.loader = loader;
  options.priors = priors_of(scene);
  return options;
}

SceneIdentity made_identity(const SceneSource& source, const fs::path& data_folder) {
  const fs::path folder = made_folder(source, data_folder);
  SceneIdentity identity{
      {{"scene", glassroom_json(glassroom_options(source))}}, why_make(source, folder)};
  identity.document["scene"]["max_pixels"] = source.max_pixels;
  add_reading(options_of(source), data_folder, identity.document["scene"]);
  if (!identity.why_not.empty()) return identity;
  identity.document["content"] = made_content(folder);
  identity.truth = truth_content(folder, data_folder);
  identity.document["code"] = load_code(folder, source.loader);
  return identity;
}

// Of several processes that want the scene one makes it, and the others wait.
FileLock wait_for(const fs::path& folder) {
  return FileLock::wait_for(FileLock::file_beside(folder), [&](const std::string& holder) {
    log::info(fmt::format("{}: waiting for {}, which makes it", folder.string(), holder));
  });
}

void make_source(const SceneSource& source, const fs::path& folder) {
  if (why_make(source, folder).empty()) return;
  const FileLock lock = wait_for(folder);
  const std::string why = why_make(source, folder);
  if (why.empty()) return;
  log::info(fmt::format("{}: {}; making it", folder.string(), why));
  make_glassroom(glassroom_options(source), folder, true);
  write_stage(folder, Stage::kData, make_document(source), {"."});
}

}  // namespace

SceneIdentity identify_source(const SceneSource& source, const fs::path& data_folder) {
  if (source.made()) return made_identity(source, data_folder);
  const fs::path folder = folder_of(source, data_folder);
  if (!is_there(folder))
    return {
        {{"scene", {{"max_pixels", source.max_pixels}}}},
        folder.string() + ": no such folder or file"};
  const PriorOptions& priors = source.foreign_priors;
  const std::string prior_folder = placed_priors(priors, data_folder).folder;
  if (!prior_folder.empty() && !is_there(prior_folder))
    return {{{"scene", {{"max_pixels", source.max_pixels}}}}, prior_folder + ": no such folder"};
  return {
      data_document(folder, options_of(source), data_folder),
      "",
      truth_content(folder, data_folder)};
}

SceneIdentity identity_or_why(const SceneIdentifier& identify, const SceneSource& source) try {
  return identify(source);
} catch (const Error& error) {
  return {Json::object(), error.what()};
}

std::string truth_content(const fs::path& dataset, const fs::path& data_folder) {
  const fs::path truth = released_truth(dataset);
  return truth.empty() ? "" : content_hash(truth, hash_cache(data_folder));
}

std::optional<SceneSource> find_source(
    const Profile& profile, const fs::path& dataset, const fs::path& data_folder
) {
  std::error_code code;
  for (SceneSource& source : profile.sources()) {
    if (source.made() && !glassroom_hash.here()) continue;  // nor is it made here
    if (fs::equivalent(folder_of(source, data_folder), dataset, code)) return std::move(source);
  }
  return std::nullopt;
}

Json data_document(
    const fs::path& dataset, const LoadOptions& options, const fs::path& data_folder
) {
  Json document = {
      {"scene", {{"max_pixels", options.max_pixels}}},
      {"content", content_hash(dataset, hash_cache(data_folder))},
      {"code", load_code(dataset, options.loader)}};
  add_reading(options, data_folder, document["scene"]);
  return document;
}

Json data_document_now(
    const Json& then,
    const fs::path& dataset,
    const fs::path& data_folder,
    const std::string& loader
) {
  const Json& scene = then.at("scene");
  if (!scene.contains("spp")) return data_document(dataset, options_of(scene, loader), data_folder);
  return {
      {"scene", scene}, {"content", made_content(dataset)}, {"code", load_code(dataset, loader)}};
}

LoadedScene load_source(const SceneSource& source, const fs::path& data_folder) {
  LoadedScene loaded;
  LoadOptions options = options_of(source);
  options.priors = placed_priors(source.foreign_priors, data_folder);
  loaded.folder = folder_of(source, data_folder);
  if (source.made()) make_source(source, loaded.folder);
  loaded.scene = load_scene(loaded.folder, options);
  if (!source.scene.empty()) loaded.scene.name = source.scene;
  if (!source.dataset.empty()) loaded.scene.dataset = source.dataset;
  if (source.image_ratio != 1)
    loaded.scene.data_notes.push_back(
        fmt::format("pictures: {} of the stored sides, area average", source.image_ratio)
    );
  if (source.made()) loaded.scene.spec_hash = glassroom_hash(glassroom_options(source));
  return loaded;
}

}  // namespace glint
