// SPDX-License-Identifier: MIT
#include "metrics/ssim.h"

#include "metrics/pair_metrics.h"

namespace glint {

PairMetrics ssim_metrics(std::vector<SsimBorder> borders) {
  PairMetrics result;
  for (const SsimBorder border : borders)
    result.metrics.push_back(
        {border == SsimBorder::kValid ? "ssim-wang" : "ssim-3dgs",
         "",
         Direction::kHigherIsBetter,
         3,
         config_to_json(SsimProtocol{border})}
    );
  result.score = [borders = std::move(borders
                  )](ImageView prediction, ImageView reference, std::span<const Region> regions) {
    const SsimMap map = ssim_map(prediction, reference);
    std::vector<MetricValues> rows(regions.size());
    for (std::size_t r = 0; r < regions.size(); ++r)
      for (const SsimBorder border : borders)
        rows[r].push_back(ssim_mean(map, border, regions[r].mask));
    return rows;
  };
  return result;
}

namespace {

MetricFamily ssim() {
  return view_family(ssim_metrics({SsimBorder::kZeroPadded, SsimBorder::kValid}), "rgb");
}

}  // namespace

GLINT_REGISTER(MetricFamily, ssim())

}  // namespace glint
