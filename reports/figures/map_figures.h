// SPDX-License-Identifier: MIT
// Figures of maps: every panel in the colours and ranges of the report page, which are drawn below.
// A grid without rows: nothing to show.
#pragma once

#include <vector>

#include "reports/bench/picture_grid.h"
#include "reports/figures/figure_scenes.h"

namespace glint {

// Methods (no variants) beside the truth: image, the same crop of all, depth, normal. The crop is
// the window of a third of the picture where the methods together err most.
PictureGrid qualitative_figure(const std::vector<FigureScene>& scenes);
// Of methods with two depths: image, depth of the interface and behind it, each with its truth.
PictureGrid depth_figure(const std::vector<FigureScene>& scenes);
// t of every method that has it, beside the true glass.
PictureGrid transparency_figure(const std::vector<FigureScene>& scenes);
// Base, transmission and reflection on their own, and their parts of the picture with their truth.
PictureGrid radiance_figure(const std::vector<FigureScene>& scenes);
// The rows of the ablation table as columns: image, error, depth, normal.
PictureGrid ablation_figure(const std::vector<FigureScene>& scenes);

struct Crop {
  int left = 0, top = 0, width = 0, height = 0;
};
// `errors`: [H][W][1] of each method, all of one size; at least one.
Crop crop_of_errors(const std::vector<const Image*>& errors);

}  // namespace glint
