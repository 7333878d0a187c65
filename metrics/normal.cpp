// SPDX-License-Identifier: MIT
#include "metrics/normal.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "glint/core/vec.h"
#include "metrics/reduce.h"

namespace glint {
namespace {

Vec3d normal_at(ImageView map, int x, int y) {
  const float* n = map.pixel(x, y);
  return {static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])};
}

// Zero where there is no normal.
double length_at(ImageView map, int x, int y, const NormalProtocol& protocol) {
  const double norm = length(normal_at(map, x, y));
  return std::isfinite(norm) && norm >= protocol.min_length ? norm : 0;
}

double angle_deg(Vec3d a, Vec3d b) {
  return std::atan2(length(cross(a, b)), dot(a, b)) * (180 / std::numbers::pi);
}

double angle_at(
    ImageView prediction, ImageView reference, int x, int y, const NormalProtocol& protocol
) {
  const double reference_length = length_at(reference, x, y, protocol);
  if (reference_length == 0) return kMissingReference;
  if (std::abs(reference_length - 1) >= protocol.unit_tolerance) return kDroppedReference;
  if (length_at(prediction, x, y, protocol) == 0) return protocol.missing_deg;
  return angle_deg(normal_at(prediction, x, y), normal_at(reference, x, y));
}

struct Angles {
  std::vector<double> scored;
  std::size_t predicted = 0, dropped = 0;
  std::size_t background = 0, in_background = 0;  // pixels; those of them with a prediction
};

Angles collect_angles(
    const BasicImage<double>& angles_deg,
    ImageView prediction,
    MaskView mask,
    const NormalProtocol& protocol
) {
  Angles angles;
  for (int y = 0; y < angles_deg.height(); ++y)
    for (int x = 0; x < angles_deg.width(); ++x) {
      const double angle = angles_deg.at(x, y);
      if (!counts(mask, x, y)) continue;
      if (angle == kMissingReference) {
        ++angles.background;
        angles.in_background += length_at(prediction, x, y, protocol) > 0;
        continue;
      }
      if (angle == kDroppedReference) {
        ++angles.dropped;
        continue;
      }
      angles.scored.push_back(angle);
      angles.predicted += length_at(prediction, x, y, protocol) > 0;
    }
  return angles;
}

double with_background(double mean_deg, const Angles& angles, const NormalProtocol& protocol) {
  const double n = static_cast<double>(angles.scored.size());
  const double wrong = static_cast<double>(angles.in_background);
  return (mean_deg * n + protocol.missing_deg * wrong) /
         (n + static_cast<double>(angles.background));
}

}  // namespace

BasicImage<double> normal_angles_deg(
    ImageView prediction, ImageView reference, const NormalProtocol& protocol
) {
  check_maps(prediction, reference, {}, 3);
  BasicImage<double> angles(reference.width, reference.height, 1);
  parallel_for(static_cast<std::size_t>(reference.height), 16, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < reference.width; ++x)
      angles.at(x, y) = angle_at(prediction, reference, x, y, protocol);
  });
  return angles;
}

std::optional<NormalErrors> normal_errors_from_angles(
    const BasicImage<double>& angles_deg,
    ImageView prediction,
    MaskView mask,
    const NormalProtocol& protocol
) {
  Angles angles = collect_angles(angles_deg, prediction, mask, protocol);
  if (angles.scored.empty()) return std::nullopt;
  const double n = static_cast<double>(angles.scored.size());
  NormalErrors errors;
  errors.num_pixels = angles.scored.size();
  for (const double angle : angles.scored) {
    errors.mean_deg += angle / n;
    for (std::size_t i = 0; i < errors.below.size(); ++i)
      errors.below[i] += angle < kNormalThresholdsDeg[i] ? 1 : 0;
  }
  for (double& share : errors.below) share *= 100 / n;
  errors.coverage = 100 * static_cast<double>(angles.predicted) / n;
  const double dropped = static_cast<double>(angles.dropped);
  errors.dropped = 100 * dropped / (dropped + n);
  errors.median_deg = median(angles.scored);
  errors.mean_with_background_deg = with_background(errors.mean_deg, angles, protocol);
  return errors;
}

std::optional<NormalErrors> normal_errors(
    ImageView prediction, ImageView reference, MaskView mask, const NormalProtocol& protocol
) {
  check_maps(prediction, reference, mask, 3);
  const BasicImage<double> angles = normal_angles_deg(prediction, reference, protocol);
  return normal_errors_from_angles(angles, prediction, mask, protocol);
}

}  // namespace glint
