// SPDX-License-Identifier: MIT
#include "metrics/transparency.h"

#include "metrics/metric.h"

namespace glint::view_metrics {
namespace {

// Inside a region of one kind only, an IoU would be a recall: whole images only.
std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  std::vector<MetricValues> values;
  if (pair.rendered["transparency"].empty() || pair.glass.empty()) return values;
  for (const Region& region : regions) {
    MetricValues row = {
        {}, transparency_mae(pair.rendered["transparency"], pair.glass, region.mask)};
    if (region.name.empty()) row[0] = transparency_iou(pair.rendered["transparency"], pair.glass);
    values.push_back(row);
  }
  return values;
}

MetricFamily transparency() {
  const Json protocol = config_to_json(TransparencyProtocol{});
  return {
      {{"transparency-iou", "", Direction::kHigherIsBetter, 3, protocol},
       {"transparency-mae", "", Direction::kLowerIsBetter, 3, protocol}},
      evaluate};
}

}  // namespace

GLINT_REGISTER(MetricFamily, transparency())

}  // namespace glint::view_metrics
