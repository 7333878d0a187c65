// SPDX-License-Identifier: MIT
// The radiance components of the whole image's glass pixels; one number each, since other regions
// have no glass or are glass already.
#include "metrics/components.h"

#include <algorithm>

#include "metrics/metric.h"
#include "metrics/psnr.h"

namespace glint::view_metrics {
namespace {

std::optional<double> component_psnr(
    ImageView predicted, ImageView component, ImageView other, const ViewPair& pair
) {
  if (predicted.empty()) return std::nullopt;
  return glint::psnr(
      predicted, displayed_component(pair.truth["rgb"], component, other), pair.glass
  );
}

std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  const bool has_glass = std::any_of(regions.begin(), regions.end(), [](const Region& region) {
    return region.name == "glass";
  });
  const bool has_truth = !pair.truth["rgb"].empty() && !pair.truth["transmitted"].empty() &&
                         !pair.truth["reflected"].empty();
  std::vector<MetricValues> values(regions.size(), MetricValues(2));
  if (!has_glass || !has_truth) return values;
  for (std::size_t r = 0; r < regions.size(); ++r)
    if (regions[r].name.empty())
      values[r] = {
          component_psnr(
              pair.rendered["transmitted"], pair.truth["transmitted"], pair.truth["reflected"], pair
          ),
          component_psnr(
              pair.rendered["reflected"], pair.truth["reflected"], pair.truth["transmitted"], pair
          )};
  return values;
}

MetricFamily components() {
  Json protocol = config_to_json(PsnrProtocol{});
  protocol["pixels"] = "glass";
  protocol["reference"] = "displayed pixel x share of the linear radiance, per channel";
  const Direction higher = Direction::kHigherIsBetter;
  return {
      {{"trans-psnr", "dB", higher, 2, protocol}, {"refl-psnr", "dB", higher, 2, protocol}},
      evaluate};
}

}  // namespace

GLINT_REGISTER(MetricFamily, components())

}  // namespace glint::view_metrics
