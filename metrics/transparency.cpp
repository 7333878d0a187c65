// SPDX-License-Identifier: MIT
#include "metrics/transparency.h"

#include <algorithm>
#include <cmath>

#include "metrics/reduce.h"

namespace glint {
namespace {

void check_transparency(ImageView transparency, MaskView glass, MaskView mask) {
  GLINT_CHECK(
      transparency.channels == 1 && transparency.size() == glass.size(),
      kBadPrediction,
      "transparency has {} x {} pixels with {} channels, the glass mask {} x {} with 1",
      transparency.width,
      transparency.height,
      transparency.channels,
      glass.width,
      glass.height
  );
  GLINT_CHECK(
      mask.empty() || mask.size() == glass.size(),
      kBadReference,
      "mask has {} x {} pixels, the glass mask {} x {}",
      mask.width,
      mask.height,
      glass.width,
      glass.height
  );
  check_finite(transparency, ExitCode::kBadPrediction, "transparency");
}

double transparency_at(ImageView map, int x, int y) {
  return static_cast<double>(std::clamp(map.at(x, y), 0.0f, 1.0f));
}

}  // namespace

std::optional<double> transparency_iou(
    ImageView transparency, MaskView glass, MaskView mask, const TransparencyProtocol& protocol
) {
  check_transparency(transparency, glass, mask);
  const Sum true_glass =
      sum_pixels(glass.size(), mask, [&](int x, int y) { return glass.at(x, y) != 0 ? 1.0 : 0.0; });
  if (!(true_glass.mean().value_or(0) > 0)) return std::nullopt;
  // The mean over the union of "in both".
  const Sum sum = sum_rows<Sum>(glass.height, [&](int y) {
    Sum row;
    for (int x = 0; x < glass.width; ++x) {
      const bool called = transparency_at(transparency, x, y) >= protocol.threshold;
      const bool truth = glass.at(x, y) != 0;
      if (counts(mask, x, y) && (called || truth)) row += {called && truth ? 1.0 : 0.0, 1};
    }
    return row;
  });
  return sum.mean();
}

std::optional<double> best_threshold_iou(ImageView map, MaskView glass) {
  constexpr int kThresholds = 19;
  std::optional<double> best;
  for (int i = 1; i <= kThresholds; ++i) {
    const double threshold = static_cast<double>(i) / (kThresholds + 1);
    const auto iou = transparency_iou(map, glass, {}, {threshold});
    if (iou && (!best || *iou > *best)) best = iou;
  }
  return best;
}

std::optional<double> transparency_mae(ImageView transparency, MaskView glass, MaskView mask) {
  check_transparency(transparency, glass, mask);
  const Sum sum = sum_pixels(glass.size(), mask, [&](int x, int y) {
    return std::abs(transparency_at(transparency, x, y) - (glass.at(x, y) != 0 ? 1.0 : 0.0));
  });
  return sum.mean();
}

}  // namespace glint
