// SPDX-License-Identifier: MIT
// Masks of glass that some methods are given, as their publications give them masks made by other
// networks: a prior (diffrens/glass) where the view has one, else the dataset's ground truth. Which
// of them a run was given is a fact that readers of tables need: glass_mask_note().
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "glint/scene/scene.h"

namespace glint {

inline constexpr const char* kGlassMasks = "glass masks";  // in Method::inputs()

// [H][W][1], 1: glass. Empty: the view has none.
const Image& glass_mask(const View& view);

struct MaskCounts {
  std::size_t views = 0, prior = 0, truth = 0;  // the last two: views that get theirs from there

  bool none() const { return prior + truth == 0; }
  bool all() const { return prior + truth == views; }
};
MaskCounts count_glass_masks(const std::vector<View>& views);

// "the prior folder's", "the dataset's ground truth", "none", or how many of each.
std::string glass_mask_note(const MaskCounts& counts);

// Of the pixels that masks call glass, in views with an albedo prior: the share whose mean RGB lies
// below `low_albedo`. Nothing where there are none.
std::optional<double> dark_share_of_glass(const std::vector<View>& views, float low_albedo);

}  // namespace glint
