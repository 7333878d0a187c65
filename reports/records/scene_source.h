// SPDX-License-Identifier: MIT
// From a profile's scene to a loaded Scene: GlassRoom scenes are made once and kept in --data.
#pragma once

#include <functional>
#include <string>

#include "glint/core/files.h"
#include "glint/scene/scene.h"
#include "reports/records/profile.h"

namespace glint {

struct LoadedScene {
  Scene scene;
  fs::path folder;  // where it lies
};

// What a scene is without loading it: its generator's options and version for made scenes; empty
// for folders, whose loader hashes the data.
std::string scene_hash(const SceneSource& source);

// Makes the scene first when it is missing. Errors (kBadReference, kEnvironment): as make_glassroom
// and load_scene.
LoadedScene load_source(const SceneSource& source, const fs::path& data_folder);

using SceneLoader = std::function<LoadedScene(const SceneSource&)>;

}  // namespace glint
