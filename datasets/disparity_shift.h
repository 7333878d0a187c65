// SPDX-License-Identifier: MIT
// Monocular disparity is 1 / depth up to scale and shift, and the shift has to be known before it
// is inverted. It is told from the scene's sparse points, which every method gets; never from true
// depth.
#pragma once

#include "datasets/scene_index.h"

namespace glint {

// Scale and shift of 1 / z = scale (d + shift).
struct DisparityFit {
  double scale = 0, shift = 0;
};

// Least squares over pairs of stored disparity and known depth z > 0, repeated without the fifth
// that fits worst: some points are wrong or hidden. Nothing: fewer than 20 pairs, a scale that is
// not positive, or less than half of 1 / z explained (correlation of 0.7).
std::optional<DisparityFit> fit_disparity(
    const std::vector<double>& disparity, const std::vector<double>& z
);

// Sets prior_reading.disparity_shift of all views with a disparity prior; of views where nothing
// fits, the median of the others' shifts. Adds a note of how many were told. Without points, or
// where no view fits, shifts stay 0 and the note says so. Files that cannot be read are passed
// over: load() names them.
void tell_disparity_shifts(SceneIndex& index);

}  // namespace glint
