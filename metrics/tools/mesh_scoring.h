// SPDX-License-Identifier: MIT
// From two surfaces to the report of glint-mesh.
#pragma once

#include <vector>

#include "metrics/tools/mesh_output.h"

namespace glint {

// Both, by the report's protocol. Errors: cull_surface()'s, kBadPrediction of the prediction.
void cull_surfaces(MeshReport& report, const std::vector<Camera>& cameras);

// Scores and curve. Errors: OutOfMemory before anything is drawn; surface_distances()'s.
void score_surfaces(MeshReport& report);

}  // namespace glint
