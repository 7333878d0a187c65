// SPDX-License-Identifier: MIT
// Orders of points across surfaces (metrics/orders.h): "order-pairs", "order-triplets" and
// "order-quadruplets". Of data that tells layers apart by all of them, of other rooms by the first
// surface and the one behind glass.
#include "metrics/layers.h"
#include "metrics/metric.h"
#include "metrics/orders.h"

namespace glint::view_metrics {
namespace {

constexpr const char* kSizes[] = {"pairs", "triplets", "quadruplets"};  // of 2, 3 and 4 points
constexpr const char* kBehind = "behind_depth";

struct TrueSurfaces {
  std::vector<ImageView> depths;  // nearest first; empty: not known
  MaskImage pixels;               // that count and may have more than one
};

TrueSurfaces true_surfaces(const ViewPair& pair, MaskView counted) {
  const TrueLayers layers(pair.truth, pair.glass, counted);
  TrueSurfaces surfaces;
  if (layers.known()) {
    for (const MapId id : kLayerDepth) surfaces.depths.push_back(pair.truth[id]);
    surfaces.pixels = layers.opening();
  } else if (pair.truth.has("depth") && pair.truth.has(kBehind) && !pair.glass.empty()) {
    surfaces = {{pair.truth["depth"], pair.truth[kBehind]}, layers.glass(1)};
  }
  return surfaces;
}

std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  const TrueSurfaces surfaces = true_surfaces(pair, regions.front().mask);
  if (surfaces.depths.empty() || !pair.rendered.has("depth")) return {};
  const auto predicted = [&](LayerPoint p) -> std::optional<float> {
    const ImageView map = predicted_layer_depth(pair.rendered, p.layer);
    return map.empty() ? std::nullopt : std::optional(map.at(p.x, p.y));
  };
  MetricValues row;
  for (int size = 2; size <= 4; ++size)
    row.push_back(percent_in_order(
        draw_tuples(surfaces.depths, surfaces.pixels, size, OrderProtocol{}), predicted
    ));
  return {row};
}

MetricFamily layer_orders() {
  MetricFamily family{{}, evaluate};
  for (std::size_t i = 0; i < 3; ++i) {
    const Json protocol = {
        {"points", i + 2},
        {"draws", OrderProtocol{}.draws},
        {"margin", OrderProtocol{}.margin},
        {"generator", "MMIX, from 0"},
        {"pixels", "whose first surface is glass or a mirror"},
        {"surfaces", "layers; without them the first and the one behind glass"},
        {"without_a_depth", "wrong"}};
    family.metrics.push_back(
        {std::string("order-") + kSizes[i], "%", Direction::kHigherIsBetter, 1, protocol}
    );
  }
  return family;
}

}  // namespace

GLINT_REGISTER(MetricFamily, layer_orders())

}  // namespace glint::view_metrics
