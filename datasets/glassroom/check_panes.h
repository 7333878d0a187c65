// SPDX-License-Identifier: MIT
// Panes that touch have no order along a ray: which one it meets first is left to rounding.
#pragma once

#include "datasets/glassroom/trace_scene.h"

namespace glint {

// Errors (kBadReference): two meshes of thin glass come nearer to each other than `gap` metres, or
// cross; both are named.
void check_panes(const TraceScene& scene, double gap = 1e-3);

}  // namespace glint
