// SPDX-License-Identifier: MIT
// How much the priors carry: scores of one room over the levels of its simulated priors. Scenes are
// taken for variants of a room by their names, LEVEL or ROOM-LEVEL (prior_levels()).
#pragma once

#include <vector>

#include "glint/drawing/canvas.h"
#include "reports/figures/figure_methods.h"

namespace glint {

// PSNR on glass, depth error and IoU of transparency: a row of charts a room of which two levels at
// least have finished, a line a method, means over seeds with bars from the smallest to the largest
// value. Empty: there is no such room.
Drawing priors_figure(const std::vector<Record>& records, const MethodChoice& choice);

// The numbers of that figure: {"levels", "points": of each room, method, metric and level that has
// any the "values" of the seeds, "mean", "low", "high"}. Null: there is no such room.
Json priors_table(const std::vector<Record>& records, const MethodChoice& choice);

}  // namespace glint
