// SPDX-License-Identifier: MIT
// Depth behind glass in two parts: what stands just behind the pane, as the content of a glass
// container, which is seen through glass alone; and what lies farther behind, the room, which other
// views see without glass. A method may be good at one by means that do not help with the other.
#include "metrics/depth.h"
#include "metrics/metric.h"

namespace glint::view_metrics {
namespace {

// Metres of depth behind the pane (docs/reference/metrics.md).
constexpr float kContentWithin = 1.25f;

// Glass pixels of which the surface behind lies within that distance, or beyond it.
MaskImage glass_in_front_of(const ViewPair& pair, bool content) {
  const ImageView first = pair.truth["depth"], behind = pair.truth["behind_depth"];
  MaskImage mask(behind.width, behind.height, 1);
  for (std::size_t i = 0; i < behind.num_pixels(); ++i) {
    const bool near = behind.data[i] - first.data[i] < kContentWithin;
    mask.data()[i] = pair.glass.data[i] != 0 && near == content ? 255 : 0;
  }
  return mask;
}

MetricValues whole_image(const ViewPair& pair) {
  MetricValues row(2);
  const ImageView depth = pair.rendered_or("behind_depth", "depth");
  if (depth.empty()) return row;
  for (const bool content : {true, false}) {
    const MaskImage mask = glass_in_front_of(pair, content);
    if (const auto e = depth_errors(depth, pair.truth["behind_depth"], mask))
      row[content ? 0 : 1] = e->absrel;
  }
  return row;
}

std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  const bool known = !pair.truth["behind_depth"].empty() && !pair.truth["depth"].empty();
  if (!known || pair.glass.empty()) return {};
  std::vector<MetricValues> values;
  for (const Region& region : regions)
    values.push_back(region.name.empty() ? whole_image(pair) : MetricValues(2));
  return values;
}

MetricFamily behind_split() {
  Json protocol = config_to_json(DepthProtocol{});
  protocol["pixels"] = "glass";
  protocol["map"] = "behind_depth";
  protocol["without_second_layer"] = "depth";
  protocol["content_within_m"] = kContentWithin;
  MetricFamily family{{}, evaluate};
  for (const char* id : {"behind-absrel-content", "behind-absrel-beyond"})
    family.metrics.push_back({id, "", Direction::kLowerIsBetter, 3, protocol});
  return family;
}

}  // namespace

GLINT_REGISTER(MetricFamily, behind_split())

}  // namespace glint::view_metrics
