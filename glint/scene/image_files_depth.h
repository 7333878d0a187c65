// SPDX-License-Identifier: MIT
// Depth maps of others: floats are metres, integers count steps (ScanNet, TUM, RealSense).
#pragma once

#include <optional>
#include <string>

#include "glint/core/files.h"
#include "glint/core/image.h"

namespace glint {

inline constexpr double kMillimetre = 1e-3;  // metres; the step of ScanNet and of our own exports

// Metres of one step of integers, and who says so, in words for protocols.
struct DepthSteps {
  double metres = 0;
  std::string from;  // "--depth-scale", "scene.json", "the median"; empty: not known
  bool known() const { return !from.empty(); }
};

// One channel in metres, 0 where there is none: floats as stored, integers times the scale. Errors
// (kBadReference): read_image()'s; integers whose scale is not known.
Image read_depth(const fs::path& path, const DepthSteps& scale);

// Of GlassRecon (arXiv 2604.18336), whose intrinsics/NAME.json beside evaluation_depths/,
// completed_depths/ and sensor_depths/ have "depth_scale", by which its values are multiplied,
// whatever their type.
DepthSteps glassrecon_depth_scale(const fs::path& path);
// The same with it. Errors (kBadReference): read_image()'s.
Image read_glassrecon_depth(const fs::path& path, const DepthSteps& scale);

// Of a file in a folder that says of itself that maps lie there (scene.json with side_maps, as our
// exports have it), at most three levels up. Errors (kBadReference): a step that is no length.
DepthSteps exported_depth_scale(const fs::path& path);

// Millimetres where they bring the median of a file of integers within a factor of two to that of
// `reference` (metres), over pixels where both have depth.
DepthSteps depth_scale_by(const fs::path& path, ImageView reference);

}  // namespace glint
