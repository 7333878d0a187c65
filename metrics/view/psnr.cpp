// SPDX-License-Identifier: MIT
#include "metrics/psnr.h"

#include "metrics/metric.h"

namespace glint::view_metrics {
namespace {

std::vector<MetricValues> evaluate(const ViewPair& pair, std::span<const Region> regions) {
  std::vector<MetricValues> values;
  if (pair.rendered["rgb"].empty() || pair.truth["rgb"].empty()) return values;
  for (const Region& region : regions)
    values.push_back(
        {glint::psnr(pair.rendered["rgb"], pair.truth["rgb"], region.mask),
         glint::psnr_8bit(pair.rendered["rgb"], pair.truth["rgb"], region.mask)}
    );
  return values;
}

}  // namespace

MetricFamily psnr() {
  const Json plain = config_to_json(PsnrProtocol{}), saved = config_to_json(psnr_8bit_protocol());
  const Direction higher = Direction::kHigherIsBetter;
  return {{{"psnr", "dB", higher, 2, plain}, {"psnr-8bit", "dB", higher, 2, saved}}, evaluate};
}

}  // namespace glint::view_metrics
