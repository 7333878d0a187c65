// SPDX-License-Identifier: MIT
// The parts of check_indexed() that look at one view's files, and at maps against cameras.
#pragma once

#include <vector>

#include "datasets/scene_index.h"

namespace glint {

// Missing and unreadable files, sizes that differ, values that are not finite or out of range,
// camera values. Checks: missing-file, unreadable-file, wrong-size, non-finite, depth-values,
// normal-length, intrinsics-size, intrinsics, pose, and those of check_layers.h. `stored`: the size
// of the picture where it could be read and the camera could be brought to it.
std::vector<Finding> check_view_files(const ViewSource& view, ImageSize& stored);

// Depth and normals against the cameras, over a sample of views. Checks: ray-length-depth,
// depth-poses, normal-axes. Views whose files cannot be used are passed over: check_view_files()
// has named them.
void check_agreement(const SceneIndex& index, std::vector<Finding>& findings);

}  // namespace glint
