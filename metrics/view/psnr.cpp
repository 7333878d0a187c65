// SPDX-License-Identifier: MIT
#include "metrics/psnr.h"

#include "metrics/metric.h"

namespace glint::view_metrics {
namespace {

std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  std::vector<MetricValues> values;
  if (pair.rgb.empty() || pair.true_rgb.empty()) return values;
  for (const Region& region : regions)
    values.push_back(
        {glint::psnr(pair.rgb, pair.true_rgb, region.mask),
         glint::psnr_8bit(pair.rgb, pair.true_rgb, region.mask)}
    );
  return values;
}

MetricFamily psnr() {
  const Json plain = config_to_json(PsnrProtocol{}), saved = config_to_json(psnr_8bit_protocol());
  const Direction higher = Direction::kHigherIsBetter;
  return {{{"psnr", "dB", higher, 2, plain}, {"psnr-8bit", "dB", higher, 2, saved}}, evaluate};
}

}  // namespace

GLINT_REGISTER(MetricFamily, psnr())

}  // namespace glint::view_metrics
