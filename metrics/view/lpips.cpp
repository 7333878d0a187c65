// SPDX-License-Identifier: MIT
// LPIPS of every network whose weights the machine has, looked for once in a process.
#include "metrics/lpips.h"

#include "metrics/metric.h"

namespace glint::view_metrics {
namespace {

struct Variant {
  const char *id, *network;
  LpipsRange range;
};
constexpr Variant kVariants[] = {
    {"lpips-alex", "alex", LpipsRange::kSymmetric},
    {"lpips-squeeze", "squeeze", LpipsRange::kSymmetric},
    {"lpips-vgg", "vgg", LpipsRange::kSymmetric},
    {"lpips-vgg-3dgs", "vgg", LpipsRange::kUnit}};

using WeightsByNetwork = std::map<std::string, std::shared_ptr<const LpipsWeights>>;

std::shared_ptr<const LpipsWeights> weights_of(const std::string& network) {
  static const WeightsByNetwork weights = [] {
    WeightsByNetwork found;
    for (const LpipsNetwork& each : lpips_networks())
      found[each.name] = lpips_weights_at(lpips_weights_place(), each.name);
    return found;
  }();
  return weights.at(network);
}

std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  std::vector<MetricValues> values(regions.size(), MetricValues(std::size(kVariants)));
  if (pair.rgb.empty() || pair.true_rgb.empty()) return values;
  for (std::size_t v = 0; v < std::size(kVariants); ++v) {
    const auto weights = weights_of(kVariants[v].network);
    if (weights == nullptr) continue;
    Lpips lpips(weights, kVariants[v].range);
    if (!lpips.accepts(pair.true_rgb.size())) continue;
    const std::vector<LpipsMap> taps = lpips.tap_maps(pair.rgb, pair.true_rgb);
    for (std::size_t r = 0; r < regions.size(); ++r)
      values[r][v] = lpips_mean(taps, regions[r].mask);
  }
  return values;
}

MetricFiles files(const Metric& metric) {
  const auto weights = weights_of(metric.protocol.at("network"));
  if (weights == nullptr) return {"no weights"};
  return {"", lpips_provenance(*weights)};
}

MetricFamily lpips() {
  MetricFamily family{{}, evaluate, files};
  for (const Variant& variant : kVariants)
    family.metrics.push_back(
        {variant.id,
         "",
         Direction::kLowerIsBetter,
         3,
         config_to_json(LpipsProtocol{variant.network, variant.range})}
    );
  return family;
}

}  // namespace

GLINT_REGISTER(MetricFamily, lpips())

}  // namespace glint::view_metrics
