// SPDX-License-Identifier: MIT
// What figures show of a scene: one test view, its truth and what each method rendered of it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "glint/drawing/picture_grid.h"
#include "reports/figures/figures.h"
#include "reports/figures/map_crops.h"
#include "reports/pictures/layers.h"

namespace glint {

struct FigureScene {
  std::string name, view;
  bool chosen_view = false;  // by FigureView, not by kViewRule
  std::vector<Crop> crops;   // of FigureView
  DepthScale scale;
  MaskImage glass;                           // empty: the data have none
  LayerMaps truth;                           // ids of page_layers()
  std::map<std::string, LayerMaps> methods;  // the first finished seed of each
  std::map<std::string, fs::path> runs;      // run folder of each
  fs::path data;                             // the scene's folder
  Camera camera;                             // of the view
  std::vector<Camera> train_cameras;
};

inline constexpr const char* kViewRule = "the test view with the largest share of glass";

// The view after kViewRule, the first of equals; without glass the middle one.
std::size_t figure_view(const std::vector<View>& views);

// "views: 0002 of room_1, ...", and the rule that chose them.
LegendLine views_line(const std::vector<FigureScene>& scenes);

// Scenes whose data can be loaded, in the order of the records; others with a warning. Errors
// (kUsage): what FigureView asks for is not there.
std::vector<FigureScene> figure_scenes(
    const std::vector<Record>& records, const FigureOptions& options
);

}  // namespace glint
