// SPDX-License-Identifier: MIT
// A dataset as the reference of a metric's program: its views as a loader gives them, of a folder
// or of a packed scene, so that the numbers are those of the tables.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "glint/core/files.h"
#include "glint/scene/scene.h"

namespace glint {

// A folder that a loader is sure of; a file named as packed scenes are, room.safetensors.
bool is_dataset(const fs::path& path);

class DatasetViews {
 public:
  // The test views, or all. `prediction`: renders that are compared with them; a run folder that
  // was made with --max-pixels has them loaded at that size. Errors: load_scene()'s.
  DatasetViews(const fs::path& dataset, bool all_views, const fs::path& prediction);

  // By their names in file names. Only those with the map ("rgb", "depth").
  std::map<std::string, const View*> with_map(const std::string& map) const;

 private:
  Scene scene_;
};

// "rgb" or the truth of another map; empty: the view has none.
const Image& map_of(const View& view, const std::string& map);

}  // namespace glint
