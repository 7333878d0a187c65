// SPDX-License-Identifier: MIT
// Two renderings of one scene beside each other, by their linear radiance: is one brighter than the
// other, and where.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "glint/core/files.h"
#include "glint/core/image.h"

namespace glint {

// Sums over the pixels of a region and their channels.
struct RadianceSums {
  double first = 0, second = 0;
  std::size_t pixels = 0;

  RadianceSums& operator+=(const RadianceSums& other);
  // Mean radiance of the second over that of the first; none: a region without pixels or light.
  std::optional<double> ratio() const;
};

struct RadianceDifference {
  RadianceSums opaque, glass;
  // Sum over blocks of 8x8 pixels (those cut off at the right and below are left out) of the
  // squared relative difference of their means: noise is averaged, what is structured stays.
  double block_squares = 0;
  std::size_t blocks = 0;

  RadianceDifference& operator+=(const RadianceDifference& other);
  RadianceSums all() const;
  std::optional<double> block_rms() const;
};

// Radiance maps [H][W][3] of one size; `glass` [H][W], or empty: everything is opaque.
RadianceDifference radiance_difference(
    ImageView first, ImageView second, const std::vector<bool>& glass
);

// (second - first) / first of means over 5x5 pixels, of all channels; huge where only the first is
// black.
Image relative_difference(ImageView first, ImageView second);

struct ComparedView {
  std::string name;
  RadianceDifference difference;
};

// gt/rgb/<view>.exr of both folders, glass by gt/glass/<view>.png of the first. With `picture`, a
// PNG of a row a view is written there: the first, the second, and their relative difference, blue
// where the second is darker, red where it is brighter, full at `range`. Errors (kBadReference): no
// view that both have, sizes that differ, unreadable files.
std::vector<ComparedView> compare_renderings(
    const fs::path& first, const fs::path& second, const fs::path& picture, float range
);

}  // namespace glint
