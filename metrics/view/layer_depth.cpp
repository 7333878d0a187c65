// SPDX-License-Identifier: MIT
// Depth of each surface along a ray, of the pixels that have more than one: "layer-2-absrel", ...;
// and of the first opaque one, "layer-last-absrel", by which methods with any number of layers are
// compared. Only of data that tells layers apart, and of the whole image: other regions are glass
// or have none.
#include "metrics/depth.h"

#include "metrics/layers.h"
#include "metrics/metric.h"

namespace glint::view_metrics {
namespace {

void add_errors(ImageView predicted, ImageView truth, MaskView mask, MetricValues& row) {
  row.resize(row.size() + 2);
  if (predicted.empty() || truth.empty()) return;
  if (const auto e = depth_errors(predicted, truth, mask)) {
    row[row.size() - 2] = e->absrel;
    row.back() = e->coverage;
  }
}

std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  const MaskView counted = regions.front().mask;
  const TrueLayers layers(pair.truth, pair.glass, counted);
  if (!layers.known()) return {};
  MetricValues row;
  for (int k = 1; k <= kMaxLayers; ++k)
    add_errors(
        predicted_layer_depth(pair.rendered, k), pair.truth[kLayerDepth[k - 1]], layers.seen(k), row
    );
  add_errors(predicted_opaque_depth(pair.rendered), layers.opaque_depth(), counted, row);
  return {row};
}

Json protocol(const char* pixels, std::string_view map) {
  Json json = config_to_json(DepthProtocol{});
  json["pixels"] = pixels;
  json["map"] = map;
  return json;
}

void add_metrics(const std::string& layer, const Json& protocol, MetricFamily& family) {
  const std::string id = "layer-" + layer;
  family.metrics.push_back({id + "-absrel", "", Direction::kLowerIsBetter, 3, protocol});
  family.metrics.push_back({id + "-coverage", "%", Direction::kHigherIsBetter, 1, protocol});
}

MetricFamily layer_depth() {
  MetricFamily family{{}, evaluate};
  add_metrics("1", protocol("first surface glass or mirror", "depth"), family);
  for (int k = 2; k <= kMaxLayers; ++k) {
    Json json =
        protocol("with such a layer behind glass or in a mirror", kLayerDepth[k - 1].row().id);
    json["with_fewer_layers"] = "the deepest one's";
    json["with_separate_second_layer"] = "behind_depth";
    json["with_one_layer"] = "none";
    add_metrics(std::to_string(k), json, family);
  }
  Json last = protocol(
      "first opaque surface behind glass or in a mirror", "deepest layer with a depth at the pixel"
  );
  last["layers"] = kMaxLayers;
  last["with_separate_second_layer"] = "behind_depth";
  last["with_one_layer"] = "depth";
  add_metrics("last", last, family);
  return family;
}

}  // namespace

GLINT_REGISTER(MetricFamily, layer_depth())

}  // namespace glint::view_metrics
