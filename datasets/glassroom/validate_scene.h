// SPDX-License-Identifier: MIT
// Checks of a TraceScene before anything is built from it.
#pragma once

#include "datasets/glassroom/trace_scene.h"

namespace glint {

// Errors (kBadReference) name the material, texture or mesh and its field: index out of range,
// arrays of different lengths, values not finite, negative or above 1 where that would create
// energy.
void validate_scene(const TraceScene& scene);

}  // namespace glint
