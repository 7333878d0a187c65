// SPDX-License-Identifier: MIT
#include "metrics/normal.h"

#include "metrics/metric.h"

namespace glint::view_metrics {
namespace {

std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  std::vector<MetricValues> values;
  if (pair.normal.empty() || pair.true_normal.empty()) return values;
  const BasicImage<double> angles = normal_angles_deg(pair.normal, pair.true_normal);
  for (const Region& region : regions) {
    MetricValues row(9);
    if (const auto e = normal_errors_from_angles(angles, pair.normal, region.mask)) {
      row = {e->mean_deg, e->median_deg};
      row.insert(row.end(), e->below.begin(), e->below.end());
      row.insert(row.end(), {e->coverage, e->dropped});
    }
    values.push_back(row);
  }
  return values;
}

MetricFamily normal() {
  const Json protocol = config_to_json(NormalProtocol{});
  const Direction lower = Direction::kLowerIsBetter, higher = Direction::kHigherIsBetter;
  MetricFamily family;
  family.metrics = {
      {"normal-mae", "deg", lower, 2, protocol}, {"normal-median", "deg", lower, 2, protocol}};
  for (const double threshold : kNormalThresholdsDeg)
    family.metrics.push_back({fmt::format("normal-{}", threshold), "%", higher, 2, protocol});
  family.metrics.push_back({"normal-coverage", "%", higher, 2, protocol});
  family.metrics.push_back({"normal-dropped", "%", lower, 2, protocol});
  family.evaluate = evaluate;
  return family;
}

}  // namespace

GLINT_REGISTER(MetricFamily, normal())

}  // namespace glint::view_metrics
