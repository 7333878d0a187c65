// SPDX-License-Identifier: MIT
#include "metrics/psnr.h"

#include "metrics/pair_metrics.h"

namespace glint {

PairMetrics psnr_metrics(const PsnrProtocol& protocol) {
  const char* id = protocol.eight_bit ? "psnr-8bit" : "psnr";
  const auto score =
      [protocol](ImageView prediction, ImageView reference, std::span<const Region> regions) {
        std::vector<MetricValues> rows;
        for (const Region& region : regions)
          rows.push_back({psnr_from_mse(mse(prediction, reference, region.mask, protocol))});
        return rows;
      };
  return {{{id, "dB", Direction::kHigherIsBetter, 2, config_to_json(protocol)}}, score};
}

namespace {

MetricFamily psnr() {
  return view_family(joined(psnr_metrics({}), psnr_metrics(psnr_8bit_protocol())), "rgb");
}

}  // namespace

GLINT_REGISTER(MetricFamily, psnr())

}  // namespace glint
