// SPDX-License-Identifier: MIT
// transforms.json and its kin: camera-to-world matrices with OpenGL axes (x right, y up, z towards
// the viewer), intrinsics per frame or for all, OpenCV distortion. Poses are used as they stand:
// nothing is recentred or scaled, applied_transform and applied_scale stay applied.
#pragma once

#include "datasets/scene_index.h"
#include "glint/core/config.h"

namespace glint {

// Errors (kBadReference): no JSON, no list `frames`.
Json parse_transforms(const fs::path& path);

// Adds a view a frame, named by its normalised file_path. Frames that cannot be used become
// problems of the index.
void read_frames(const Json& json, const fs::path& file, SceneIndex& index);

// A folder with transforms.json as nerfstudio has it, with its split lists and its point cloud.
SceneIndex index_nerfstudio(const fs::path& folder, const LoadOptions& options);

}  // namespace glint
