// SPDX-License-Identifier: MIT
#include <algorithm>

#include "glint/drawing/chart.h"
#include "reports/run/perf/scaling.h"
#include "reports/show/figures/figure_methods.h"

namespace glint {

namespace {

std::vector<std::string> methods_of(const std::vector<ScalingSweep>& sweeps) {
  std::vector<std::string> methods;
  for (const ScalingSweep& sweep : sweeps)
    if (std::find(methods.begin(), methods.end(), sweep.method) == methods.end())
      methods.push_back(sweep.method);
  return methods;
}

Chart chart_of(
    const std::vector<ScalingSweep>& sweeps,
    ScalingVariable variable,
    double ScalingPoint::*value,
    const char* label
) {
  const std::vector<std::string> methods = methods_of(sweeps);
  Chart chart{
      variable == ScalingVariable::kSurfels ? "surfels of a set" : "pixels", label, {}, true};
  for (const ScalingSweep& sweep : sweeps) {
    if (sweep.variable != variable) continue;
    const auto index = std::find(methods.begin(), methods.end(), sweep.method) - methods.begin();
    ChartSeries series{static_cast<std::size_t>(index), sweep.variables(), {}};
    for (const ScalingPoint& point : sweep.points) series.y.push_back(point.*value);
    chart.series.push_back(std::move(series));
  }
  return chart;
}

void draw(const fs::path& png, const std::vector<ScalingSweep>& sweeps) {
  ChartSheet sheet;
  sheet.chart_width = 240;
  for (const std::string& method : methods_of(sweeps)) sheet.names.push_back(method_title(method));
  const auto row = [&](double ScalingPoint::*value, const char* label) {
    sheet.rows.push_back(
        {"",
         {chart_of(sweeps, ScalingVariable::kSurfels, value, label),
          chart_of(sweeps, ScalingVariable::kPixels, value, label)}}
    );
  };
  row(&ScalingPoint::ms, "a training step (ms)");
  row(&ScalingPoint::memory_mb, "memory (MB)");
  write_drawing(png, draw_charts(sheet));
}

}  // namespace

GLINT_PROVIDE(draw_scaling, draw)

}  // namespace glint
