// SPDX-License-Identifier: MIT
// How well a transparency map, [H][W][1] in [0, 1], finds the glass of the ground-truth mask.
#pragma once

#include <optional>

#include "glint/core/config.h"
#include "glint/core/image.h"

namespace glint {

struct TransparencyProtocol {
  double threshold = 0.5;  // at or above: called glass
  static constexpr bool clamp = true;
  template <class V>
  void visit(V&& v) {
    v("threshold", threshold, "transparency at or above it is called glass (IoU)");
    v("clamp", clamp, "the map is clamped to [0, 1]");
  }
};

// Intersection over union of called and true glass; empty when no glass is true: what
// is called glass there, transparency_mae() counts. Errors:
// kBadPrediction (size, channels, value not finite), kBadReference (mask size).
std::optional<double> transparency_iou(
    ImageView transparency,
    MaskView glass,
    MaskView mask = {},
    const TransparencyProtocol& protocol = {}
);

// The highest IoU that any threshold in 0.05, 0.10, ..., 0.95 gives: what a map that was not made
// to be one of transparency (a specularity, say) could tell of the glass, at best.
std::optional<double> best_threshold_iou(ImageView map, MaskView glass);

// Mean |transparency - glass|, glass being 0 or 1; empty when no pixel counts. Errors as above.
std::optional<double> transparency_mae(ImageView transparency, MaskView glass, MaskView mask = {});

}  // namespace glint
