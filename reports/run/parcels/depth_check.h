// SPDX-License-Identifier: MIT
// How far apart two models are in what meshes are fused from: the depth of the training views.
#pragma once

#include <vector>

#include "glint/method.h"

namespace glint {

// Of one view; `through`: depth_through_glass(), empty where the method does not look behind glass.
struct FusedDepth {
  Image depth, through;
};

// Of those of the training views. Not interrupted: who has trained a cell wants its parcel. Errors:
// the method's.
std::vector<FusedDepth> fused_depths(
    Method& method, const Scene& scene, const std::vector<std::size_t>& views
);

struct DepthDifference {
  double mean = 0;       // metres; of the layer with the larger one, where both have depth
  double one_sided = 0;  // share of the pixels where only one has

  friend bool operator==(const DepthDifference&, const DepthDifference&) = default;
};
DepthDifference depth_difference(
    const std::vector<FusedDepth>& a, const std::vector<FusedDepth>& b
);

// [N] the weight of each surfel of the cloud, rasterised on its own, summed over all pixels of the
// views.
std::vector<float> pixels_seen(const SurfelCloud& cloud, const std::vector<View>& views);

}  // namespace glint
