// SPDX-License-Identifier: MIT
// The true layers of one view against each other.
#pragma once

#include "datasets/scene_index.h"
#include "glint/scene/maps.h"

namespace glint {

// Whether a true map is of those that check_layers() looks at.
bool is_of_layers(const MapRow& row);

// Checks: layer-order (a layer nearer than the one before it), layer-behind-opaque (a layer behind
// one that is neither glass nor a mirror, or behind nothing). `truth`: what could be read of the
// view's maps; of two that are missing or differ in size nothing is said.
void check_layers(const ViewSource& view, const MapSet& truth, std::vector<Finding>& findings);

}  // namespace glint
