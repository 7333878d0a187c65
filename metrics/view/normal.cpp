// SPDX-License-Identifier: MIT
#include "metrics/normal.h"

#include "metrics/pair_metrics.h"

namespace glint {
namespace {

MetricValues values_of(const NormalErrors& errors) {
  MetricValues row = {errors.mean_deg, errors.median_deg};
  row.insert(row.end(), errors.below.begin(), errors.below.end());
  row.insert(row.end(), {errors.coverage, errors.dropped, errors.mean_with_background_deg});
  return row;
}

std::vector<MetricValues> score(
    ImageView prediction, ImageView reference, std::span<const Region> regions
) {
  const BasicImage<double> angles = normal_angles_deg(prediction, reference);
  std::vector<MetricValues> rows;
  for (const Region& region : regions) {
    const auto errors = normal_errors_from_angles(angles, prediction, region.mask);
    rows.push_back(errors ? values_of(*errors) : MetricValues(5 + kNormalThresholdsDeg.size()));
  }
  return rows;
}

}  // namespace

PairMetrics normal_metrics() {
  const Json protocol = config_to_json(NormalProtocol{});
  const Direction lower = Direction::kLowerIsBetter, higher = Direction::kHigherIsBetter;
  PairMetrics result;
  result.metrics = {
      {"normal-mae", "deg", lower, 2, protocol}, {"normal-median", "deg", lower, 2, protocol}};
  for (const double threshold : kNormalThresholdsDeg)
    result.metrics.push_back({fmt::format("normal-{}", threshold), "%", higher, 2, protocol});
  result.metrics.push_back({"normal-coverage", "%", higher, 2, protocol});
  result.metrics.push_back({"normal-dropped", "%", lower, 2, protocol});
  Json whole = protocol;
  whole["background"] = "0 where nothing is predicted, missing_deg where something is";
  result.metrics.push_back({"normal-mae-background", "deg", lower, 2, whole});
  result.score = score;
  return result;
}

namespace {

MetricFamily normal() { return view_family(normal_metrics(), "normal"); }

}  // namespace

GLINT_REGISTER(MetricFamily, normal())

}  // namespace glint
