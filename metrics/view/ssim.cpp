// SPDX-License-Identifier: MIT
#include "metrics/ssim.h"

#include "metrics/metric.h"

namespace glint::view_metrics {
namespace {

std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  std::vector<MetricValues> values;
  if (pair.rgb.empty() || pair.true_rgb.empty()) return values;
  const SsimMap map = ssim_map(pair.rgb, pair.true_rgb);
  for (const Region& region : regions)
    values.push_back(
        {ssim_mean(map, SsimBorder::kZeroPadded, region.mask),
         ssim_mean(map, SsimBorder::kValid, region.mask)}
    );
  return values;
}

MetricFamily ssim() {
  const Json padded = config_to_json(SsimProtocol{SsimBorder::kZeroPadded});
  const Json valid = config_to_json(SsimProtocol{SsimBorder::kValid});
  const Direction higher = Direction::kHigherIsBetter;
  return {{{"ssim-3dgs", "", higher, 3, padded}, {"ssim-wang", "", higher, 3, valid}}, evaluate};
}

}  // namespace

GLINT_REGISTER(MetricFamily, ssim())

}  // namespace glint::view_metrics
