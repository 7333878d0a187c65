// SPDX-License-Identifier: MIT
// Errors of normal maps: camera space, OpenCV axes, [H][W][3].
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "glint/core/config.h"
#include "glint/core/image.h"

namespace glint {

inline constexpr std::array<double, 5> kNormalThresholdsDeg = {5, 7.5, 11.25, 22.5, 30};

struct NormalProtocol {
  double missing_deg = 90;       // angle of a pixel without prediction
  double min_length = 1e-6;      // shorter, or not finite: no normal
  double unit_tolerance = 0.05;  // reference normals with | |n| - 1 | at or above it are dropped
  template <class V>
  void visit(V&& v) {
    v("missing_deg", missing_deg, "angle in degrees of a pixel without prediction");
    v("min_length", min_length, "shorter, or not finite: no normal");
    v("unit_tolerance",
      unit_tolerance,
      "reference normals with | |n| - 1 | at or above it are dropped");
  }
};

struct NormalErrors {
  double mean_deg = 0, median_deg = 0;
  // Mean over background, too, which the others leave out: pixels without a true normal count as 0
  // where nothing is predicted and as missing_deg where something is. Empty pictures thus score
  // well: papers that average over whole pictures print such numbers.
  double mean_with_background_deg = 0;
  std::array<double, 5> below{};  // percent strictly below kNormalThresholdsDeg
  double coverage = 0;            // percent of the scored pixels that have a prediction
  double dropped = 0;             // percent of the reference's normals that are not of unit length
  std::size_t num_pixels = 0;     // scored
};

// Angle in degrees at each pixel [H][W][1], by atan2(|a x b|, a . b), which keeps its precision
// near 0 and 180 where the arc cosine loses it. kMissingReference and kDroppedReference where the
// reference has no normal or one that is not of unit length (blended at edges).
inline constexpr double kMissingReference = -1, kDroppedReference = -2;
BasicImage<double> normal_angles_deg(
    ImageView prediction, ImageView reference, const NormalProtocol& protocol = {}
);

// Empty when no pixel of the mask can be scored. Errors: kBadPrediction (size, channels),
// kBadReference.
std::optional<NormalErrors> normal_errors(
    ImageView prediction,
    ImageView reference,
    MaskView mask = {},
    const NormalProtocol& protocol = {}
);

// The same from a map of angles, for several masks. `prediction` is needed for the coverage.
std::optional<NormalErrors> normal_errors_from_angles(
    const BasicImage<double>& angles_deg,
    ImageView prediction,
    MaskView mask,
    const NormalProtocol& protocol = {}
);

}  // namespace glint
