// SPDX-License-Identifier: MIT
#include "metrics/depth.h"

#include "metrics/metric.h"

namespace glint::view_metrics {
namespace {

// Fitted on the whole view, scored by region.
std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  std::vector<MetricValues> values;
  if (pair.depth.empty() || pair.true_depth.empty()) return values;
  const DepthProtocol plain, release = release_depth_protocol();
  const DepthFit fit = fit_depth(pair.depth, pair.true_depth, {}, release);
  for (const Region& region : regions) {
    const auto a = depth_errors(pair.depth, pair.true_depth, region.mask, plain, {});
    const auto b = depth_errors(pair.depth, pair.true_depth, region.mask, release, fit);
    MetricValues row(7);
    if (a) row = {a->absrel, a->rmse, a->delta1, a->coverage, {}, {}, {}};
    if (b) row[4] = b->absrel, row[5] = b->rmse, row[6] = b->delta1;
    values.push_back(row);
  }
  return values;
}

MetricFamily depth() {
  const Json plain = config_to_json(DepthProtocol{});
  const Json release = config_to_json(release_depth_protocol());
  const Direction lower = Direction::kLowerIsBetter, higher = Direction::kHigherIsBetter;
  return {
      {{"depth-absrel", "", lower, 3, plain},
       {"depth-rmse", "m", lower, 3, plain},
       {"depth-delta1", "%", higher, 2, plain},
       {"depth-coverage", "%", higher, 2, plain},
       {"depth-absrel-release", "", lower, 3, release},
       {"depth-rmse-release", "", lower, 3, release},
       {"depth-delta1-release", "%", higher, 2, release}},
      evaluate};
}

}  // namespace

GLINT_REGISTER(MetricFamily, depth())

}  // namespace glint::view_metrics
