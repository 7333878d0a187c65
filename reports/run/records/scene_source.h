// SPDX-License-Identifier: MIT
// From a profile's scene to a loaded Scene: GlassRoom scenes are made once and kept in --data.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "datasets/dataset.h"
#include "glint/core/files.h"
#include "glint/scene/scene.h"
#include "reports/run/records/profile.h"

namespace glint {

struct LoadedScene {
  Scene scene;
  fs::path folder;  // where it lies
};

// What a scene is, without loading it: the options that made it or choose from it, the content of
// its files, the code that reads them. Part of what every training goes by.
struct SceneIdentity {
  Json document;
  std::string why_not;  // it has to be made (again) first, or is not there at all; empty: it is
  std::string truth;    // truth_content()
};
// Errors (kBadReference): files that cannot be read; kEnvironment: a scene that this build cannot
// make.
SceneIdentity identify_source(const SceneSource& source, const fs::path& data_folder);
using SceneIdentifier = std::function<SceneIdentity(const SceneSource&)>;

// What cannot be identified has the error as its reason: the cell says so, and others go on.
SceneIdentity identity_or_why(const SceneIdentifier& identify, const SceneSource& source);

// Of a folder or packed file of the user's; hashes are kept below `data_folder`. Of the options the
// loader, the sizes and the priors count; their folder is as of SceneSource. Errors
// (kBadReference): as identify_source, and nothing there that a loader knows.
Json data_document(
    const fs::path& dataset, const LoadOptions& options, const fs::path& data_folder
);

// The content of truth that lies apart from the scene's folder (released_truth()): scores go by it,
// trainings do not. Empty: there is none.
std::string truth_content(const fs::path& dataset, const fs::path& data_folder);

// The scene of the profile that lies in that folder or file; nothing: there is none.
std::optional<SceneSource> find_source(
    const Profile& profile, const fs::path& dataset, const fs::path& data_folder
);

// What a training's data are now, to be compared with `then`, its document of them: of a room that
// `all` made, what its folder lists; else data_document().
Json data_document_now(
    const Json& then,
    const fs::path& dataset,
    const fs::path& data_folder,
    const std::string& loader = ""
);

// Makes the scene first when it is missing, or was made by other code. A source without names has
// those of its data. Errors (kBadReference,
// kEnvironment): as make_glassroom and load_scene.
LoadedScene load_source(const SceneSource& source, const fs::path& data_folder);

using SceneLoader = std::function<LoadedScene(const SceneSource&)>;

}  // namespace glint
