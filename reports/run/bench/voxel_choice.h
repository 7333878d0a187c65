// SPDX-License-Identifier: MIT
// The voxel of a mesh that nobody has chosen.
#pragma once

#include <string>

#include "glint/scene/scene.h"

namespace glint {

struct VoxelChoice {
  double voxel = 0;  // metres
  std::string why;   // one line for people
};

// One pixel of the training views at the scene's usual depth: depth / fx, two digits. Smaller
// voxels hold nothing that the pictures know. The depth is the median over the training views of
// the depth of the points that each sees; without points, half the diagonal of the scene's bounds.
// At least a 2000th and at most a 50th of the diagonal. Errors (kBadReference): no training view.
VoxelChoice choose_voxel(const Scene& scene);

}  // namespace glint
