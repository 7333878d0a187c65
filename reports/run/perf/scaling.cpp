// SPDX-License-Identifier: MIT
#include "reports/run/perf/scaling.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "glint/core/device.h"
#include "glint/core/machine.h"
#include "glint/core/progress.h"
#include "glint/core/rows.h"
#include "glint/method.h"
#include "glint/render/surfel_set.h"
#include "reports/run/perf/perf_scene.h"

namespace glint {

namespace {

constexpr std::size_t kLastPoints = 3;
constexpr double kNoise = 0.1;         // of a slope
constexpr double kMemoryMargin = 1.2;  // of what a point is thought to take

const char* name_of(ScalingVariable variable) {
  return variable == ScalingVariable::kSurfels ? "surfels" : "pixels";
}

double value_of(const ScalingPoint& point, ScalingVariable variable) {
  return variable == ScalingVariable::kSurfels ? static_cast<double>(point.surfels)
                                               : static_cast<double>(point.size.num_pixels());
}

// Methods that are asked for, without their variants.
std::vector<std::string> methods_of(const PerfOptions& options) {
  std::vector<std::string> methods;
  for (const auto& [id, spec] : Registry<MethodSpec>::all())
    if (spec.overrides.empty() && options.wants(id)) methods.push_back(id);
  return methods;
}

std::vector<PerfOptions> points_of(const ScalingOptions& options, ScalingVariable variable) {
  std::vector<PerfOptions> points;
  if (variable == ScalingVariable::kSurfels) {
    for (const std::size_t surfels : options.surfels) {
      points.push_back(options.base);
      points.back().surfels = surfels;
    }
    return points;
  }
  for (const ImageSize size : options.sizes) {
    points.push_back(options.base);
    points.back().width = size.width;
    points.back().height = size.height;
  }
  return points;
}

double pairs_of(const PerfOptions& options) {
  SurfelSet set(perf_cloud(options));
  set.forward(perf_scene(options).train.front().camera, 0);
  return static_cast<double>(set.pass().rasterizer.num_pixel_pairs());
}

// In words where the next point would take more memory than there is; memory grows at most with the
// variable.
std::string too_large(const ScalingSweep& sweep, const ScalingPoint& next) {
  if (sweep.points.empty()) return "";
  const ScalingPoint& last = sweep.points.back();
  const double growth = value_of(next, sweep.variable) / value_of(last, sweep.variable);
  const double megabytes = kMemoryMargin * growth * last.memory_mb;
  const double free =
      static_cast<double>(on_gpu() ? device_room() : available_memory_bytes()) / 1e6;
  if (megabytes <= free) return "";
  return fmt::format(
      "{} {}: about {:.0f} MB, {:.0f} MB are free",
      value_of(next, sweep.variable),
      name_of(sweep.variable),
      megabytes,
      free
  );
}

ScalingSweep sweep_of(
    const ScalingOptions& options,
    const std::string& method,
    ScalingVariable variable,
    Progress& progress
) {
  ScalingSweep sweep{method, variable, {}, {}};
  for (const PerfOptions& at : points_of(options, variable)) {
    ScalingPoint point{at.surfels, {at.width, at.height}};
    const std::string reason = too_large(sweep, point);
    if (reason.empty()) {
      point.pairs = pairs_of(at);
      const StepCost cost = cost_of_step(method, at);
      point.ms = 1000 * cost.seconds;
      point.memory_mb = cost.memory_mb;
      sweep.points.push_back(point);
    } else {
      sweep.left_out.push_back(reason);
    }
    progress.advance(1, method);
  }
  return sweep;
}

double fitted_slope(std::span<const double> x, std::span<const double> y) {
  const auto n = static_cast<double>(x.size());
  if (x.size() < 2) return std::nan("");
  double mean_x = 0, mean_y = 0, xy = 0, xx = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += std::log(x[i]) / n;
    mean_y += std::log(y[i]) / n;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += (std::log(x[i]) - mean_x) * (std::log(y[i]) - mean_y);
    xx += (std::log(x[i]) - mean_x) * (std::log(x[i]) - mean_x);
  }
  return xy / xx;
}

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Cell slope_cell(const ScalingSweep& sweep, double ScalingPoint::*value) {
  const LogSlope slope = sweep.slope_of(value);
  return {
      {{"fitted", number_or_null(slope.fitted)}, {"last", number_or_null(slope.last)}},
      std::isfinite(slope.fitted) ? fmt::format("{:.2f} {:.2f}", slope.fitted, slope.last) : "-"};
}

Cell points_cell(const ScalingSweep& sweep) {
  Json points = Json::array();
  std::string words;
  for (const auto& [surfels, size, pairs, ms, memory_mb] : sweep.points) {
    points.push_back(
        {{"surfels", surfels},
         {"width", size.width},
         {"height", size.height},
         {"pairs", pairs},
         {"ms", ms},
         {"memory_mb", memory_mb}}
    );
    words += fmt::format("{:.0f} ({:.0f}) ", ms, memory_mb);
  }
  return {points, words + (sweep.is_steep() ? " STEEPER THAN LINEAR" : "")};
}

Rows listed(const std::vector<ScalingSweep>& sweeps) {
  Rows list(
      {{"method", "method"},
       {"variable", "against"},
       {"time_slope", "time"},
       {"memory_slope", "memory"},
       {"pairs_slope", "pairs"},
       {"points", "ms (MB)"}},
      "left_out steep"
  );
  for (const ScalingSweep& sweep : sweeps)
    list.add(
        {sweep.method,
         name_of(sweep.variable),
         slope_cell(sweep, &ScalingPoint::ms),
         slope_cell(sweep, &ScalingPoint::memory_mb),
         slope_cell(sweep, &ScalingPoint::pairs),
         points_cell(sweep),
         sweep.left_out,
         sweep.is_steep()}
    );
  return list;
}

}  // namespace

LogSlope log_slope(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t last = std::min(kLastPoints, x.size());
  return {fitted_slope(x, y), fitted_slope(std::span(x).last(last), std::span(y).last(last))};
}

std::vector<double> ScalingSweep::variables() const {
  std::vector<double> values;
  for (const ScalingPoint& point : points) values.push_back(value_of(point, variable));
  return values;
}

LogSlope ScalingSweep::slope_of(double ScalingPoint::*value) const {
  std::vector<double> values;
  for (const ScalingPoint& point : points) values.push_back(point.*value);
  return log_slope(variables(), values);
}

bool ScalingSweep::is_steep() const {
  const double of_pairs = std::max(1.0, slope_of(&ScalingPoint::pairs).last);
  return slope_of(&ScalingPoint::ms).last > of_pairs + kNoise;
}

std::vector<ScalingSweep> run_scaling(const ScalingOptions& options) {
  const std::vector<std::string> methods = methods_of(options.base);
  std::vector<ScalingSweep> sweeps;
  Progress progress("scaling", methods.size() * (options.surfels.size() + options.sizes.size()));
  for (const std::string& method : methods)
    for (const ScalingVariable variable : {ScalingVariable::kSurfels, ScalingVariable::kPixels})
      sweeps.push_back(sweep_of(options, method, variable, progress));
  return sweeps;
}

Json scaling_to_json(const ScalingOptions& options, const std::vector<ScalingSweep>& sweeps) {
  Json json = perf_setting(options.base);
  json["rows"] = listed(sweeps).json();
  return json;
}

std::string scaling_to_text(
    const ScalingOptions& options, const std::vector<ScalingSweep>& sweeps
) {
  std::string text = fmt::format(
      "steps of each method, the least of {} runs, {}; base {}x{} and {} surfels a set\n"
      "slopes of logarithms: through all points, through the last three (1: linear)\n{}",
      options.base.runs,
      device_name(),
      options.base.width,
      options.base.height,
      options.base.surfels,
      listed(sweeps).text()
  );
  for (const ScalingSweep& sweep : sweeps)
    for (const std::string& reason : sweep.left_out)
      text += fmt::format("{} left out: {}\n", sweep.method, reason);
  return text;
}

}  // namespace glint
