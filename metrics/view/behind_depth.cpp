// SPDX-License-Identifier: MIT
// Depth of the first opaque surface behind glass, scored on glass pixels only. A method with one
// layer is scored by its one depth, which may be that of the surface behind.
//
// Methods differ in which depth they report (expected, median, of a plane) and in whether they fill
// holes, which alone moves the score: so besides the depth that a method calls its own, every
// method is scored by the expected and by the median depth of its set, and by the last mode of its
// weights (glint/render/depth_modes.h), holes and all, with their coverage.
#include "metrics/depth.h"
#include "metrics/metric.h"

namespace glint::view_metrics {
namespace {

struct Estimate {
  const char* suffix;            // of the metrics' ids
  MapId map;                     // that is scored
  std::optional<MapId> instead;  // what a method without the map is scored by; else nothing
};
const Estimate kEstimates[] = {
    {"", "behind_depth", MapId("depth")},
    {"-expected", "behind_expected", {}},
    {"-median", "behind_median", {}},
    {"-last-mode", "last_mode", {}}};

ImageView scored_map(const ViewPair& pair, const Estimate& estimate) {
  return pair.rendered_or(estimate.map, estimate.instead.value_or(estimate.map));
}

// AbsRel and coverage of each.
MetricValues whole_image(const ViewPair& pair) {
  MetricValues row;
  for (const Estimate& estimate : kEstimates) {
    row.resize(row.size() + 2);
    const ImageView depth = scored_map(pair, estimate);
    if (depth.empty()) continue;
    if (const auto e = depth_errors(depth, pair.truth["behind_depth"], pair.glass)) {
      row[row.size() - 2] = e->absrel;
      row.back() = e->coverage;
    }
  }
  return row;
}

std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  if (pair.truth["behind_depth"].empty() || pair.glass.empty()) return {};
  std::vector<MetricValues> values;
  for (const Region& region : regions)
    values.push_back(
        region.name.empty() ? whole_image(pair) : MetricValues(2 * std::size(kEstimates))
    );
  return values;
}

MetricFamily behind_depth() {
  MetricFamily family{{}, evaluate};
  for (const Estimate& estimate : kEstimates) {
    Json protocol = config_to_json(DepthProtocol{});
    protocol["pixels"] = "glass";
    protocol["map"] = estimate.map.row().id;
    if (estimate.instead) protocol["without_second_layer"] = estimate.instead->row().id;
    const std::string suffix = estimate.suffix;
    family.metrics.push_back({"behind-absrel" + suffix, "", Direction::kLowerIsBetter, 3, protocol}
    );
    family.metrics.push_back(
        {"behind-coverage" + suffix, "%", Direction::kHigherIsBetter, 1, protocol}
    );
  }
  return family;
}

}  // namespace

GLINT_REGISTER(MetricFamily, behind_depth())

}  // namespace glint::view_metrics
