// SPDX-License-Identifier: MIT
// Metrics of a predicted and a true map, one definition for tables (view/) and programs (tools/):
// ids, units, protocol and how both maps become values.
#pragma once

#include "metrics/depth.h"
#include "metrics/lpips.h"
#include "metrics/metric.h"
#include "metrics/psnr.h"
#include "metrics/ssim.h"

namespace glint {

struct PairMetrics {
  std::vector<Metric> metrics;
  // A row per region, a value per metric; empty where nothing can be scored. Errors: those of the
  // metric's function.
  std::function<
      std::vector<MetricValues>(ImageView prediction, ImageView reference, std::span<const Region>)>
      score;
};

// "psnr" of what was rendered, "psnr-8bit" of what was saved: by the protocol.
PairMetrics psnr_metrics(const PsnrProtocol& protocol);
// "ssim-3dgs", "ssim-wang": a metric per border, of one map.
PairMetrics ssim_metrics(std::vector<SsimBorder> borders);
// "depth-absrel" + suffix, -rmse, -delta1, and "depth-coverage". A fit is that of the first region.
PairMetrics depth_metrics(const DepthProtocol& protocol, const std::string& suffix);
// "normal-mae", -median, shares below angles, coverage, dropped.
PairMetrics normal_metrics();
// "lpips-alex", ...; the network has one set of buffers: not to be scored by two threads at once.
PairMetrics lpips_metrics(std::shared_ptr<Lpips> lpips, const LpipsProtocol& protocol);
Metric lpips_metric(const LpipsProtocol& protocol);

// Both; a metric of `b` that `a` has, too, is left out.
PairMetrics joined(PairMetrics a, PairMetrics b);

// Of views: both sides' map. Nothing where a side lacks it.
MetricFamily view_family(PairMetrics metrics, MapId map);

}  // namespace glint
