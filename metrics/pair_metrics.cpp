// SPDX-License-Identifier: MIT
#include "metrics/pair_metrics.h"

#include <algorithm>

namespace glint {

PairMetrics joined(PairMetrics a, PairMetrics b) {
  PairMetrics both;
  both.metrics = a.metrics;
  std::vector<std::size_t> kept;
  for (std::size_t m = 0; m < b.metrics.size(); ++m) {
    const bool known = std::any_of(a.metrics.begin(), a.metrics.end(), [&](const Metric& metric) {
      return metric.id == b.metrics[m].id;
    });
    if (known) continue;
    kept.push_back(m);
    both.metrics.push_back(b.metrics[m]);
  }
  both.score = [a = std::move(a.score),
                b = std::move(b.score),
                kept](ImageView prediction, ImageView reference, std::span<const Region> regions) {
    std::vector<MetricValues> rows = a(prediction, reference, regions);
    const std::vector<MetricValues> more = b(prediction, reference, regions);
    for (std::size_t r = 0; r < rows.size(); ++r)
      for (const std::size_t m : kept) rows[r].push_back(more[r][m]);
    return rows;
  };
  return both;
}

MetricFamily view_family(PairMetrics metrics, MapId map) {
  MetricFamily family;
  family.metrics = std::move(metrics.metrics);
  family.evaluate = [score = std::move(metrics.score), map](
                        const ViewPair& pair, std::span<const Region> regions
                    ) -> std::vector<MetricValues> {
    const ImageView prediction = pair.rendered[map], reference = pair.truth[map];
    if (prediction.empty() || reference.empty()) return {};
    return score(prediction, reference, regions);
  };
  return family;
}

}  // namespace glint
