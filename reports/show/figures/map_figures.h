// SPDX-License-Identifier: MIT
// Figures of maps: every panel in the colours and ranges of the report page, which are drawn below.
// A grid without rows: nothing to show.
#pragma once

#include <vector>

#include "glint/drawing/picture_grid.h"
#include "reports/show/figures/figure_scenes.h"

namespace glint {

// Methods (no variants) beside the truth: image, depth, normal, each with the same crops of all
// (map_crops.h).
PictureGrid qualitative_figure(const std::vector<FigureScene>& scenes);
// Of methods that look behind glass: image and every depth, each with its truth.
PictureGrid depth_figure(const std::vector<FigureScene>& scenes);
// Every share (t, k_s) of every method that has it, beside the true glass.
PictureGrid transparency_figure(const std::vector<FigureScene>& scenes);
// Image, radiance of each surfel set on its own, and the parts of the image, with their truth.
PictureGrid radiance_figure(const std::vector<FigureScene>& scenes);
// The rows of the ablation table as columns: image, error, depth, normal.
PictureGrid ablation_figure(const std::vector<FigureScene>& scenes);

}  // namespace glint
