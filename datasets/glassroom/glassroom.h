// SPDX-License-Identifier: MIT
// GlassRoom: procedural rooms with a glass container, to the recipe of GLINT's 3D-FRONT-T. They are
// our own rooms, never called 3D-FRONT-T. One call writes a whole scene folder.
#pragma once

#include <cstdint>
#include <string>

#include "datasets/glassroom/prior_levels.h"
#include "glint/core/config.h"
#include "glint/core/files.h"
#include "glint/core/service.h"

namespace glint {

struct GlassRoomOptions {
  // "room_1" ... "room_5", and those beyond first order: "nested_1", "window_1", "mirror_1",
  // "tinted_1". The name seeds the layout.
  std::string scene = "room_1";
  int width = 160, height = 90;  // pixels
  int views = 64;                // along the camera path; every 8th is a test view
  // Samples a pixel of a training view. Test views get four times as many: noise in training views
  // averages out, in a test view it bounds the score.
  int spp = 64;
  std::uint64_t seed = 0;  // varies the layout of the same recipe
  std::string assets;      // empty: furniture from files is gone, but keys name the field
  std::string priors = kDefaultPriorLevel;  // how good the simulated priors are (priors.h)
  bool layers = false;  // the maps of every layer and path, of the five rooms; others have them

  template <class V>
  void visit(V&& v) {
    v("scene", scene, "room_1 ... room_5, nested_1, window_1, mirror_1, tinted_1");
    v("width", width, "pixels");
    v("height", height, "pixels");
    v("views", views, "views along the camera path");
    v("spp", spp, "samples a pixel of a training view; test views get four times as many");
    v("seed", seed, "varies the layout");
    v("assets", assets, "empty; earlier versions: folder with glTF furniture");
    v("priors", priors, "perfect, good, default, poor, bad: how good the simulated priors are");
    v("layers", layers, "true maps of every layer and path, which other scenes than rooms have");
  }
};

inline constexpr const char* kGlassRoomElsewhere =
    "make and pack the scene with the full build (glint-bench dataset make, dataset pack)";

// Scenes beyond first order have the maps of every layer and path by themselves.
inline bool always_has_layers(const std::string& scene) { return !scene.starts_with("room_"); }

// The options as keys and scene.json have them. Default priors are not named, as before there were
// others, nor layers where they are off or always there.
inline Json glassroom_json(const GlassRoomOptions& options) {
  Json json = config_to_json(options);
  if (options.priors == kDefaultPriorLevel) json.erase("priors");
  if (!options.layers || always_has_layers(options.scene)) json.erase("layers");
  return json;
}

// Hash of the options and of the generator's version: the cache key, written to scene.json.
inline constinit Service<std::string(const GlassRoomOptions&)> glassroom_hash{
    "the version of a glassroom", kGlassRoomElsewhere};

// Makes the scene in `folder` unless it is there already with the same hash (then returns false;
// with `again` it is made all the same).
// Rendered into a temporary folder and renamed, so an interrupted run leaves no half scene. A scene
// of an earlier release gets gt/mesh_behind.ply added.
inline constinit Service<bool(const GlassRoomOptions& options, const fs::path& folder, bool again)>
    make_glassroom{"making a glassroom", kGlassRoomElsewhere};

}  // namespace glint
