// SPDX-License-Identifier: MIT
// How priors of other programs are stored: where they lie, the axes of normals, what depth counts.
// From the command line, from a profile's scene, or from scene.json.
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace glint {

// Camera axes of stored normals, or the world's.
enum class PriorAxes {
  kOpencv,        // x right, y down, z forward: what is used inside
  kOpengl,        // x right, y up, z to the viewer: (x, -y, -z)
  kStableNormal,  // x left, y up, z to the viewer: (-x, -y, -z)
  kWorld,         // the world's
};
inline constexpr std::array<std::string_view, 4> kPriorAxes{
    "opencv", "opengl", "stablenormal", "world"};

// What a larger value of a depth prior means.
enum class PriorDepth {
  kLinear,     // farther, affine in depth: what is used inside
  kDisparity,  // nearer, affine in 1 / depth
  kInverted,   // nearer, affine in depth
};
inline constexpr std::array<std::string_view, 3> kPriorDepths{"linear", "disparity", "inverted"};

struct PriorOptions {
  std::string folder;  // with files of other programs (prior_files.h); empty: none
  std::string axes;    // one of kPriorAxes, "auto", or empty: what scene.json says, else auto
  std::string depth;   // one of kPriorDepths, "auto", or empty likewise
  int overlap = -1;    // frames that two chunks share; below 0: told from the files
  bool albedo_from_basecolor = false;  // base colour x (1 - metallic) where there is no albedo

  bool operator==(const PriorOptions&) const = default;
};

// Errors (kUsage): a word that is none of the above; `where` opens the message.
void check_prior_options(const PriorOptions& options, std::string_view where);

// How the stored maps of one scene are read.
struct PriorReading {
  PriorAxes axes = PriorAxes::kOpencv;
  PriorDepth depth = PriorDepth::kLinear;
  // Of one view: what is added to its stored disparities before they are inverted, in their units.
  float disparity_shift = 0;
};

}  // namespace glint
