// SPDX-License-Identifier: MIT
// Finds the renders that another program left: which file is which map of which test view.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "glint/core/files.h"

namespace glint {

// Where programs put a map, as folders/file below the given folder, best first. '*' in a folder
// means its last match in natural order, in the file any name. A file may also lie in a folder per
// view.
struct MapPlaces {
  std::string map;  // id in the table (glint/scene/maps.h)
  std::vector<std::string> places;
};
// Own run folders, the layouts of 3DGS, 2DGS and PGSR (test/ours_*/renders, vis/depth_*.tiff),
// 3DGRUT (ours_*/renders), nerfstudio (test/rgb), EasyVolcap, EnvGS and GLINT (RENDER, geo_metric;
// pred and geometry), nerfbaselines (color), gsplat (renders/val_*), and plain folders rgb, depth,
// normal. Adding a layout is adding a line. The image comes first.
std::vector<MapPlaces> map_places();

// How files were given to views.
enum class Matching { kName, kOrder };

struct PredictionFiles {
  std::vector<std::map<std::string, fs::path>> views;  // map -> file, of each view
  std::map<std::string, Matching> matching;            // by map
  fs::path mesh;                                       // empty: none found
};

// For views of those names. Files go by the view's name (file or folder), else, where there are as
// many files as views, by their natural order. Errors (kBadPrediction): no picture at all; a map
// with neither the views' names nor their number (both lists are quoted).
PredictionFiles find_predictions(
    const fs::path& folder, const std::vector<std::string>& view_names
);

// Files whose name or folder speaks of the map ("depth") and that no view was given: for warnings.
std::vector<fs::path> unread_files(
    const fs::path& folder, const std::string& map, const PredictionFiles& found
);

}  // namespace glint
