// SPDX-License-Identifier: MIT
// LPIPS of every network whose weights the machine has, looked for once in a process.
#include "metrics/lpips.h"

#include "metrics/pair_metrics.h"

namespace glint {

Metric lpips_metric(const LpipsProtocol& protocol) {
  const char* suffix = protocol.range == LpipsRange::kUnit ? "-3dgs" : "";
  return {
      "lpips-" + protocol.network + suffix,
      "",
      Direction::kLowerIsBetter,
      3,
      config_to_json(protocol)};
}

PairMetrics lpips_metrics(std::shared_ptr<Lpips> lpips, const LpipsProtocol& protocol) {
  const auto score = [lpips = std::move(lpips)](
                         ImageView prediction, ImageView reference, std::span<const Region> regions
                     ) {
    const std::vector<LpipsMap> taps = lpips->tap_maps(prediction, reference);
    std::vector<MetricValues> rows;
    for (const Region& region : regions) rows.push_back({lpips_mean(taps, region.mask)});
    return rows;
  };
  return {{lpips_metric(protocol)}, score};
}

namespace {

struct Variant {
  const char* network;
  LpipsRange range;
  LpipsProtocol protocol() const { return {network, range}; }
};
constexpr Variant kVariants[] = {
    {"alex", LpipsRange::kSymmetric}, {"vgg", LpipsRange::kSymmetric}, {"vgg", LpipsRange::kUnit}};

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
  const ImageView rendered = pair.rendered["rgb"], truth = pair.truth["rgb"];
  if (rendered.empty() || truth.empty()) return values;
  for (std::size_t v = 0; v < std::size(kVariants); ++v) {
    const auto weights = weights_of(kVariants[v].network);
    if (weights == nullptr) continue;
    const auto lpips = std::make_shared<Lpips>(weights, kVariants[v].range);
    if (!lpips->accepts(truth.size())) continue;
    const PairMetrics metrics = lpips_metrics(lpips, kVariants[v].protocol());
    const std::vector<MetricValues> rows = metrics.score(rendered, truth, regions);
    for (std::size_t r = 0; r < regions.size(); ++r) values[r][v] = rows[r][0];
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
    family.metrics.push_back(lpips_metric(variant.protocol()));
  return family;
}

}  // namespace

GLINT_REGISTER(MetricFamily, lpips())

}  // namespace glint
