// SPDX-License-Identifier: MIT
// Depth of the first mode of the weights along a ray against the first surface, by region: on glass
// it says whether the method has something at the pane at all, whatever the depth that it reports.
// The last mode is scored as an estimate of depth behind glass, see behind_depth.cpp.
#include "metrics/depth.h"
#include "metrics/metric.h"

namespace glint::view_metrics {
namespace {

constexpr MapId kMap = "first_mode";

std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  if (pair.rendered[kMap].empty() || pair.truth["depth"].empty()) return {};
  std::vector<MetricValues> values;
  for (const Region& region : regions) {
    values.emplace_back(2);
    if (const auto e = depth_errors(pair.rendered[kMap], pair.truth["depth"], region.mask))
      values.back() = {e->absrel, e->coverage};
  }
  return values;
}

MetricFamily first_mode() {
  Json protocol = config_to_json(DepthProtocol{});
  protocol["map"] = "first_mode";
  return {
      {{"depth-absrel-first-mode", "", Direction::kLowerIsBetter, 3, protocol},
       {"depth-coverage-first-mode", "%", Direction::kHigherIsBetter, 1, protocol}},
      evaluate};
}

}  // namespace

GLINT_REGISTER(MetricFamily, first_mode())

}  // namespace glint::view_metrics
