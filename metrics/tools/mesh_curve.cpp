// SPDX-License-Identifier: MIT
#include "glint/drawing/chart.h"
#include "metrics/tools/mesh_output.h"

namespace glint {
namespace {

constexpr double kChartWidth = 236;  // points, a column of a paper

ChartSeries series_of(
    std::size_t index, const std::vector<ThresholdScores>& curve, double ThresholdScores::*value
) {
  ChartSeries series{index, {}, {}};
  for (const ThresholdScores& at : curve) {
    series.x.push_back(100 * at.threshold_m);
    series.y.push_back(at.*value);
  }
  return series;
}

}  // namespace

Drawing draw_f1_curve(const std::vector<ThresholdScores>& curve) {
  ChartSheet sheet{{}, {}, {"F1", "precision", "recall"}, kChartWidth};
  const Chart chart{
      "distance (cm)",
      "score",
      {series_of(0, curve, &ThresholdScores::f1),
       series_of(1, curve, &ThresholdScores::precision),
       series_of(2, curve, &ThresholdScores::recall)}};
  sheet.rows.push_back({"", {chart}});
  return draw_charts(sheet);
}

}  // namespace glint
