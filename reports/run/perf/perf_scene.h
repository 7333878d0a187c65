// SPDX-License-Identifier: MIT
// The scene that ops are timed on: surfels on the walls and boxes of a room, seen from inside, with
// the sizes and opacities of a trained model.
#pragma once

#include "glint/scene/scene.h"
#include "reports/run/perf/perf.h"

namespace glint {

// Two training views, 20 cm apart, each other's neighbours for losses of two views; surfels as
// trained ones: most opaque, some faint, overlapping.
Scene perf_scene(const PerfOptions& options);
SurfelCloud perf_cloud(const PerfOptions& options);

}  // namespace glint
