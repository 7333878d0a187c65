// SPDX-License-Identifier: MIT
// Compares what rasterize() made with what the reference renderer made.
#pragma once

#include <algorithm>
#include <cmath>

#include "tests/support/reference_render.h"

namespace glint::test {

// A cut-off nearer than this (relative) may fall on the other side in float: the pixel is not
// clean. Image coordinates of a few hundred pixels carry 2^-24 of themselves, a splat is at least
// 0.7 pixels wide, and rho at the cut-off grows by 6 per sigma: about 1e-4; ten times that for
// slanted surfels.
inline constexpr double kCutoffGuard = 1e-3;
// Centre depths are one transform away from the input: a few roundings.
inline constexpr double kOrderGuard = 1e-5;

inline bool is_clean(const Cutoffs& c) {
  return std::min({c.accept, c.branch, c.transmittance}) > kCutoffGuard && c.order > kOrderGuard;
}

// Largest differences at clean pixels; depths relative to max(1, depth).
struct RenderErrors {
  double features = 0, alpha = 0, depth_sum = 0, depth_median = 0, normal = 0, distortion = 0;
  double plane_distance = 0;
  std::size_t clean = 0, near_cutoff = 0;
  std::size_t flipped = 0;  // near a cut-off, and visibly on its other side

  double largest() const {
    return std::max({features, alpha, depth_sum, depth_median, normal, distortion, plane_distance});
  }
};

inline double relative_difference(double actual, double expected) {
  const double difference = std::abs(actual - expected) / std::max(1.0, std::abs(expected));
  return std::isnan(difference) ? Cutoffs::kNone : difference;
}

// Differences at one pixel. Maps that are made only when asked for may be empty.
inline RenderErrors pixel_errors(
    const RasterOutput& output, const ReferencePixel& expected, int x, int y
) {
  RenderErrors errors;
  for (std::size_t c = 0; c < expected.features.size(); ++c) {
    const auto actual = static_cast<double>(output.features.pixel(x, y)[c]);
    errors.features = std::max(errors.features, relative_difference(actual, expected.features[c]));
  }
  for (int k = 0; k < 3; ++k) {
    const auto actual = static_cast<double>(output.normal.at(x, y, k));
    errors.normal = std::max(errors.normal, relative_difference(actual, expected.normal[k]));
  }
  const auto difference = [&](const Image& map, double value) {
    return map.empty() ? 0.0 : relative_difference(static_cast<double>(map.at(x, y)), value);
  };
  errors.alpha = difference(output.alpha, expected.alpha);
  errors.depth_sum = difference(output.depth_sum, expected.depth_sum);
  if (expected.cutoffs.median > kCutoffGuard)
    errors.depth_median = difference(output.depth_median, expected.depth_median);
  errors.distortion = difference(output.distortion, expected.distortion);
  errors.plane_distance = difference(output.plane_distance, expected.plane_distance);
  return errors;
}

// Adds counts and keeps the larger differences.
inline void add_errors(RenderErrors& total, const RenderErrors& other) {
  for (const auto member :
       {&RenderErrors::features,
        &RenderErrors::alpha,
        &RenderErrors::depth_sum,
        &RenderErrors::depth_median,
        &RenderErrors::normal,
        &RenderErrors::distortion,
        &RenderErrors::plane_distance})
    total.*member = std::max(total.*member, other.*member);
  total.clean += other.clean;
  total.near_cutoff += other.near_cutoff;
  total.flipped += other.flipped;
}

// Every `stride`-th pixel in reading order.
inline RenderErrors compare_render(
    const RasterOutput& output, const ReferenceRenderer& reference, ImageSize size, int stride = 1
) {
  RenderErrors total;
  for (int i = 0; i < size.width * size.height; i += stride) {
    const int x = i % size.width, y = i / size.width;
    const ReferencePixel expected = reference.pixel(x, y);
    const RenderErrors errors = pixel_errors(output, expected, x, y);
    if (is_clean(expected.cutoffs)) {
      add_errors(total, errors);
      ++total.clean;
    } else {
      ++total.near_cutoff;
      total.flipped += errors.largest() > kCutoffGuard ? 1 : 0;
    }
  }
  return total;
}

}  // namespace glint::test
