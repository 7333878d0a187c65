// SPDX-License-Identifier: MIT
#include "reports/run/parcels/depth_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "glint/render/surfel_set.h"
#include "reports/run/bench/mesh_stage.h"

namespace glint {
namespace {

struct DifferenceSum {
  double sum = 0;
  std::size_t both = 0, one = 0;

  void add(const Image& a, const Image& b) {
    if (a.size() != b.size()) {  // a layer that only one has
      one += std::max(a.num_pixels(), b.num_pixels());
      return;
    }
    for (std::size_t i = 0; i < a.num_pixels(); ++i) {
      const float x = a.data()[i], y = b.data()[i];
      if (x > 0 && y > 0) {
        sum += std::abs(static_cast<double>(x) - static_cast<double>(y));
        ++both;
      } else {
        one += (x > 0) != (y > 0);
      }
    }
  }
  DepthDifference difference() const {
    const auto pixels = static_cast<double>(std::max<std::size_t>(both + one, 1));
    return {both > 0 ? sum / static_cast<double>(both) : 0.0, static_cast<double>(one) / pixels};
  }
};

}  // namespace

std::vector<FusedDepth> fused_depths(
    Method& method, const Scene& scene, const std::vector<std::size_t>& views
) {
  std::vector<FusedDepth> depths;
  for (const std::size_t view : views) {
    const MapSet maps = method.render_view(scene.train[view]);
    depths.push_back({maps["depth"], depth_through_glass(maps)});
  }
  return depths;
}

DepthDifference depth_difference(
    const std::vector<FusedDepth>& a, const std::vector<FusedDepth>& b
) {
  DifferenceSum depth, through;
  for (std::size_t i = 0; i < a.size(); ++i) {
    depth.add(a[i].depth, b[i].depth);
    through.add(a[i].through, b[i].through);
  }
  const DepthDifference first = depth.difference(), second = through.difference();
  return {std::max(first.mean, second.mean), std::max(first.one_sided, second.one_sided)};
}

std::vector<float> pixels_seen(const SurfelCloud& cloud, const std::vector<View>& views) {
  SurfelSet set(cloud);
  std::vector<float> seen(cloud.size());
  for (const View& view : views) {
    const FloatArray& weights = set.forward(view.camera, 0).visibility;
    for (std::size_t i = 0; i < seen.size(); ++i) seen[i] += weights[i];
  }
  return seen;
}

}  // namespace glint
