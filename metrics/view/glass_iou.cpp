// SPDX-License-Identifier: MIT
// How well glass can be found from any map a method renders, so that methods without a transparency
// map compare as well: a control for transparency-iou.
#include <algorithm>

#include "metrics/metric.h"
#include "metrics/transparency.h"

namespace glint::view_metrics {
namespace {

std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  std::vector<MetricValues> values;
  if (pair.glass.empty() ||
      (pair.rendered["transparency"].empty() && pair.rendered["specularity"].empty()))
    return values;
  MetricValues row(1);
  for (const ImageView& map : {pair.rendered["transparency"], pair.rendered["specularity"]})
    if (!map.empty()) row[0] = std::max(row[0], best_threshold_iou(map, pair.glass));
  values.assign(regions.size(), MetricValues(1));
  values.front() = row;  // whole images only
  return values;
}

MetricFamily glass_iou() {
  Json protocol = Json::object();
  protocol["maps"] = "transparency, specularity: the better one";
  protocol["thresholds"] = "0.05, 0.10, ..., 0.95: the best one of each view";
  return {{{"glass-iou-best", "", Direction::kHigherIsBetter, 3, protocol}}, evaluate};
}

}  // namespace

GLINT_REGISTER(MetricFamily, glass_iou())

}  // namespace glint::view_metrics
