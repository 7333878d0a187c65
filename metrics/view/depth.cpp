// SPDX-License-Identifier: MIT
#include "metrics/depth.h"

#include "metrics/pair_metrics.h"

namespace glint {

// Fitted on the whole view, scored by region.
PairMetrics depth_metrics(const DepthProtocol& protocol, const std::string& suffix) {
  const Json json = config_to_json(protocol);
  const char* rmse_unit = protocol.rmse_over_mean_depth ? "" : "m";
  const Direction lower = Direction::kLowerIsBetter, higher = Direction::kHigherIsBetter;
  const auto score =
      [protocol](ImageView prediction, ImageView reference, std::span<const Region> regions) {
        const DepthFit fit = fit_depth(prediction, reference, regions[0].mask, protocol);
        std::vector<MetricValues> rows;
        for (const Region& region : regions) {
          rows.emplace_back(4);
          if (const auto e = depth_errors(prediction, reference, region.mask, protocol, fit))
            rows.back() = {e->absrel, e->rmse, e->delta1, e->coverage};
        }
        return rows;
      };
  return {
      {{"depth-absrel" + suffix, "", lower, 3, json},
       {"depth-rmse" + suffix, rmse_unit, lower, 3, json},
       {"depth-delta1" + suffix, "%", higher, 2, json},
       {"depth-coverage", "%", higher, 2, json}},
      score};
}

namespace {

MetricFamily depth() {
  return view_family(
      joined(depth_metrics({}, ""), depth_metrics(release_depth_protocol(), "-release")), "depth"
  );
}

}  // namespace

GLINT_REGISTER(MetricFamily, depth())

}  // namespace glint
