// SPDX-License-Identifier: MIT
// Normals of each surface along a ray, of the pixels that have more than one, where a method
// renders them. Of the whole image, as depth in layer_depth.cpp.
#include "metrics/normal.h"

#include "metrics/layers.h"
#include "metrics/metric.h"

namespace glint::view_metrics {
namespace {

std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  const TrueLayers layers(pair.truth, pair.glass, regions.front().mask);
  if (!layers.known()) return {};
  MetricValues row;
  for (int k = 1; k <= kMaxLayers; ++k) {
    row.emplace_back();
    const ImageView normal = pair.rendered[kLayerNormal[k - 1]];
    const ImageView truth = pair.truth[kLayerNormal[k - 1]];
    if (normal.empty() || truth.empty()) continue;
    if (const auto e = normal_errors(normal, truth, layers.seen(k))) row.back() = e->mean_deg;
  }
  return {row};
}

MetricFamily layer_normal() {
  MetricFamily family{{}, evaluate};
  for (int k = 1; k <= kMaxLayers; ++k) {
    Json protocol = config_to_json(NormalProtocol{});
    protocol["pixels"] =
        k == 1 ? "first surface glass or mirror" : "with such a layer behind glass or in a mirror";
    protocol["map"] = kLayerNormal[k - 1].row().id;
    family.metrics.push_back(
        {fmt::format("layer-{}-mae", k), "deg", Direction::kLowerIsBetter, 2, protocol}
    );
  }
  return family;
}

}  // namespace

GLINT_REGISTER(MetricFamily, layer_normal())

}  // namespace glint::view_metrics
