// SPDX-License-Identifier: MIT
// Medians by which lengths in another unit are told: stray values do not count.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "glint/core/image.h"
#include "glint/core/median.h"
#include "glint/core/vec.h"

namespace glint {

// The median distance from the median place; 0: there is none. Places are finite.
inline double spread_of(const std::vector<Vec3d>& places) {
  Vec3d middle{};
  std::vector<double> values(places.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::ranges::transform(places, values.begin(), [&](Vec3d place) { return place[axis]; });
    middle[axis] = upper_median(values);
  }
  std::ranges::transform(places, values.begin(), [&](Vec3d place) {
    return length(place - middle);
  });
  return upper_median(values);
}

// Of depths over those of `reference`, [H][W][1] of one size, where both are finite and above 0; 0:
// no pixel is.
inline double median_ratio(ImageView depth, ImageView reference) {
  const auto is_depth = [](float z) { return std::isfinite(z) && z > 0; };
  std::vector<double> ratios;
  for (std::size_t i = 0; i < depth.num_pixels(); ++i)
    if (const float z = depth.data[i], r = reference.data[i]; is_depth(z) && is_depth(r))
      ratios.push_back(static_cast<double>(z) / static_cast<double>(r));
  return upper_median(std::move(ratios));
}

}  // namespace glint
