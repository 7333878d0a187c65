// SPDX-License-Identifier: MIT
// The meshes of runs beside the true ones, from the camera of the figures' view.
#pragma once

#include <vector>

#include "glint/drawing/picture_grid.h"
#include "reports/show/figures/figure_scenes.h"

namespace glint {

// Truth and methods (no variants): the mesh in grey, and the distance of what was scored to the
// true surface; the same again of the meshes behind glass where a run has one. The files and the
// culling are those of the scores. A grid without rows: no run has a mesh.
PictureGrid meshes_figure(const std::vector<FigureScene>& scenes);

}  // namespace glint
