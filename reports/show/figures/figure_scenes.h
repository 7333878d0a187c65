// SPDX-License-Identifier: MIT
// What figures show of a scene: one test view, its truth and what each method rendered of it.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "glint/drawing/picture_grid.h"
#include "reports/show/figures/figure_methods.h"
#include "reports/show/figures/figures.h"
#include "reports/show/figures/map_crops.h"
#include "reports/show/pictures/layers.h"

namespace glint {

// Layers of a view by their ids. Those of runs are read when they are asked for, and not kept: all
// methods of all scenes would not fit into memory.
class FigureLayers {
 public:
  FigureLayers() = default;
  FigureLayers(LayerMaps maps) : maps_(std::move(maps)) {}  // at hand
  FigureLayers(fs::path view_folder, std::shared_ptr<const View> view)
      : folder_(std::move(view_folder)), view_(std::move(view)) {}

  bool has(const std::string& id) const;
  Image at(const std::string& id) const;  // empty: not there, or it cannot be read (a warning)

 private:
  LayerMaps maps_;
  fs::path folder_;
  std::shared_ptr<const View> view_;  // nullptr: maps at hand
};

struct FigureScene {
  std::string name, view;
  bool chosen_view = false;  // by FigureView, not by kViewRule
  std::vector<Crop> crops;   // of FigureView
  DepthScale scale;
  MaskImage glass;                              // empty: the data have none
  FigureLayers truth;                           // ids of page_layers()
  std::map<std::string, FigureLayers> methods;  // the first finished seed of each
  std::map<std::string, fs::path> runs;         // run folder of each
  fs::path data;                                // the scene's folder
  Camera camera;                                // of the view
  std::vector<Camera> train_cameras;
};

inline constexpr const char* kViewRule = "the test view with the largest share of glass";

// The view after kViewRule, the first of equals; without glass the middle one.
std::size_t figure_view(const std::vector<View>& views);

// With the methods for pictures only; where data tell the layers of glass behind glass apart, also
// variants that render a second one.
std::vector<FigureScene> with_chosen_methods(
    std::vector<FigureScene> scenes, const MethodChoice& choice
);

// "views: 0002 of room_1, ...", and the rule that chose them.
LegendLine views_line(const std::vector<FigureScene>& scenes);

// Scenes whose data can be loaded, in the order of the records; others with a warning. Errors
// (kUsage): what FigureView asks for is not there.
std::vector<FigureScene> figure_scenes(
    const std::vector<Record>& records, const FigureOptions& options
);

}  // namespace glint
