// SPDX-License-Identifier: MIT
// One range of depth for every picture of a scene.
#pragma once

#include <vector>

#include "glint/core/files.h"
#include "glint/scene/scene.h"

namespace glint {

// The limits of the depth colours in metres: the 1st and 99th percentile of the true depths of all
// views, first surface and behind glass. Without truth, of the depths that the runs rendered.
struct DepthScale {
  float low = 0, high = 1;
  bool from_truth = false;
};
// `runs`: run folders. Errors (kBadReference): a depth map is damaged.
DepthScale depth_scale(const std::vector<fs::path>& runs, const std::vector<View>& views);

}  // namespace glint
