// SPDX-License-Identifier: MIT
// Figures of curves, a row of charts a scene. Empty: nothing to show.
#pragma once

#include <vector>

#include "glint/drawing/canvas.h"
#include "reports/show/figures/figure_methods.h"

namespace glint {

// PSNR of training views by iteration (from log.jsonl of the first finished seed), and PSNR of test
// views against minutes of training and against the number of surfels, a dot a seed.
Drawing curves_figure(
    const std::vector<Record>& records, const fs::path& folder, const MethodChoice& choice
);

// F1 of the mesh, and of the mesh behind glass, over the distance that counts as near, of methods
// with two distances at least; means over seeds.
Drawing f1_figure(const std::vector<Record>& records, const MethodChoice& choice);

}  // namespace glint
