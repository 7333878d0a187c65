// SPDX-License-Identifier: MIT
// Does the method know of each surface along a ray whether it is glass? Of the last that truth
// tells apart it need not: nothing behind it is known. Of the whole image.
#include "metrics/transparency.h"

#include "metrics/layers.h"
#include "metrics/metric.h"

namespace glint::view_metrics {
namespace {

std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  const TrueLayers layers(pair.truth, pair.glass, regions.front().mask);
  if (!layers.known()) return {};
  MetricValues row;
  for (int k = 1; k < kMaxLayers; ++k) {
    row.emplace_back();
    const ImageView t = pair.rendered[kLayerTransparency[k - 1]];
    if (!t.empty()) row.back() = transparency_iou(t, layers.glass(k), layers.behind_glass(k));
  }
  return {row};
}

MetricFamily layer_transparency() {
  MetricFamily family{{}, evaluate};
  for (int k = 1; k < kMaxLayers; ++k) {
    Json protocol = config_to_json(TransparencyProtocol{});
    protocol["pixels"] = k == 1 ? "all" : "with such a layer behind glass";
    protocol["map"] = kLayerTransparency[k - 1].row().id;
    family.metrics.push_back(
        {fmt::format("layer-{}-t-iou", k), "", Direction::kHigherIsBetter, 3, protocol}
    );
  }
  return family;
}

}  // namespace

GLINT_REGISTER(MetricFamily, layer_transparency())

}  // namespace glint::view_metrics
