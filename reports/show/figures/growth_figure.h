// SPDX-License-Identifier: MIT
// Surfels, of all and of each set, and PSNR over the steps of trainings, from their logs. Trainings
// of one scene and one number of steps share a row of charts.
#pragma once

#include <string>
#include <vector>

#include "glint/drawing/canvas.h"
#include "reports/show/figures/figure_methods.h"
#include "reports/show/figures/figures.h"

namespace glint {

struct GrowthRun {
  CellKey cell;
  int steps = 0;  // it was to have; 0: as many as its log says
  fs::path log;
};

// The first finished seed of each scene and method that curves show.
std::vector<GrowthRun> growth_runs(
    const FigureOptions& options, const std::vector<Record>& records
);
// Every run in these folders, or below them. Errors (kUsage): a folder without one; those of
// read_run_spec().
std::vector<GrowthRun> growth_runs_below(const std::vector<std::string>& folders);

// Empty: no log has a line.
Drawing growth_figure(const std::vector<GrowthRun>& runs);

}  // namespace glint
