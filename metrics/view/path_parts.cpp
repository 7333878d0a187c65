// SPDX-License-Identifier: MIT
// What came to the camera by each path over two panes or mirrors, where a method renders it apart;
// on pixels whose first surface is glass or a mirror, of the whole image. Methods with two
// components have trans-psnr and refl-psnr.
#include <algorithm>

#include "metrics/components.h"
#include "metrics/layers.h"
#include "metrics/metric.h"
#include "metrics/psnr.h"

namespace glint::view_metrics {
namespace {

constexpr MapId kPaths[] = {"path_t", "path_tt", "path_r", "path_tr", "path_rt"};

std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  const TrueLayers layers(pair.truth, pair.glass, regions.front().mask);
  if (!layers.known() || !pair.truth.has("rgb")) return {};
  const MaskImage mask = layers.opening();
  if (std::ranges::none_of(mask.values(), [](auto value) { return value != 0; })) return {};
  MetricValues row;
  for (const MapId path : kPaths) {
    row.emplace_back();
    if (!pair.rendered.has(path)) continue;
    const Image truth = displayed_part(pair.truth["rgb"], pair.truth, path);
    if (!truth.empty()) row.back() = glint::psnr(pair.rendered[path], truth, mask);
  }
  return {row};
}

MetricFamily path_parts() {
  Json protocol = config_to_json(PsnrProtocol{});
  protocol["pixels"] = "first surface glass or mirror";
  protocol["reference"] =
      "displayed pixel x share of the linear radiance by all paths, per channel";
  MetricFamily family{{}, evaluate};
  for (const char* path : {"t", "tt", "r", "tr", "rt"})
    family.metrics.push_back(
        {fmt::format("path-{}-psnr", path), "dB", Direction::kHigherIsBetter, 2, protocol}
    );
  return family;
}

}  // namespace

GLINT_REGISTER(MetricFamily, path_parts())

}  // namespace glint::view_metrics
