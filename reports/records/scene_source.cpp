// SPDX-License-Identifier: MIT
#include "reports/records/scene_source.h"

#include "datasets/dataset.h"
#include "datasets/glassroom/glassroom.h"

namespace glint {

namespace {

GlassRoomOptions glassroom_options(const SceneSource& source) {
  GlassRoomOptions options;
  options.scene = source.scene;
  options.width = source.width;
  options.height = source.height;
  options.views = source.views;
  options.spp = source.spp;
  options.seed = source.seed;
  options.assets = source.assets;
  return options;
}

fs::path made_folder(const SceneSource& source, const fs::path& data_folder) {
  const std::string hash = scene_hash(source).substr(0, 8);
  return data_folder / source.dataset / fmt::format("{}-{}", source.scene, hash);
}

}  // namespace

std::string scene_hash(const SceneSource& source) {
  return source.made() ? glassroom_hash(glassroom_options(source)) : "";
}

LoadedScene load_source(const SceneSource& source, const fs::path& data_folder) {
  LoadedScene loaded;
  LoadOptions options;
  options.max_pixels = source.max_pixels;
  options.loader = source.loader;
  loaded.folder = source.made() ? made_folder(source, data_folder) : data_folder / source.folder;
  if (source.made()) make_glassroom(glassroom_options(source), loaded.folder);
  loaded.scene = load_scene(loaded.folder, options);
  loaded.scene.name = source.scene;
  loaded.scene.dataset = source.dataset;
  if (source.made()) loaded.scene.spec_hash = scene_hash(source);
  return loaded;
}

}  // namespace glint
