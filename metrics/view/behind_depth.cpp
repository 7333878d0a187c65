// SPDX-License-Identifier: MIT
// Depth of the first opaque surface behind glass, scored on glass pixels only. A method with one
// layer is scored by its one depth, which may be that of the surface behind.
#include "metrics/depth.h"
#include "metrics/metric.h"

namespace glint::view_metrics {
namespace {

std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  std::vector<MetricValues> values;
  const ImageView depth = pair.rendered["behind_depth"].empty() ? pair.rendered["depth"]
                                                                : pair.rendered["behind_depth"];
  if (depth.empty() || pair.truth["behind_depth"].empty() || pair.glass.empty()) return values;
  for (const Region& region : regions) {
    MetricValues row(1);
    if (region.name.empty())
      if (const auto e = depth_errors(depth, pair.truth["behind_depth"], pair.glass))
        row[0] = e->absrel;
    values.push_back(row);
  }
  return values;
}

MetricFamily behind_depth() {
  Json protocol = config_to_json(DepthProtocol{});
  protocol["pixels"] = "glass";
  protocol["without_second_layer"] = "depth";
  return {{{"behind-absrel", "", Direction::kLowerIsBetter, 3, protocol}}, evaluate};
}

}  // namespace

GLINT_REGISTER(MetricFamily, behind_depth())

}  // namespace glint::view_metrics
