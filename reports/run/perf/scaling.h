// SPDX-License-Identifier: MIT
// How the cost of a training step grows with surfels and with pixels, for every method.
#pragma once

#include "glint/core/image.h"
#include "glint/core/service.h"
#include "reports/run/perf/perf.h"

namespace glint {

struct ScalingOptions {
  PerfOptions base;  // scene and runs; `only`: globs over ids of methods
  std::vector<std::size_t> surfels = {10000, 30000, 100000, 300000, 1000000};  // of each set
  std::vector<ImageSize> sizes = {{160, 90}, {320, 180}, {640, 360}, {960, 540}};
};

struct ScalingPoint {
  std::size_t surfels = 0;  // of each set
  ImageSize size;
  double pairs = 0;      // pixels inside the surfels' screen boxes, of one set and view
  double ms = 0;         // of a step, the least of the runs
  double memory_mb = 0;  // see StepCost
};

enum class ScalingVariable { kSurfels, kPixels };

// The slope of a straight line through logarithms, by least squares: 1 is linear, 0 constant. And
// that through the last three points, which constants flatten less. NaN of fewer than two points.
struct LogSlope {
  double fitted = 0, last = 0;
};
LogSlope log_slope(const std::vector<double>& x, const std::vector<double>& y);

// One method, one variable.
struct ScalingSweep {
  std::string method;
  ScalingVariable variable = ScalingVariable::kSurfels;
  std::vector<ScalingPoint> points;
  std::vector<std::string> left_out;  // points that would not have fitted into memory, in words

  std::vector<double> variables() const;  // surfels or pixels of the points
  LogSlope slope_of(double ScalingPoint::*value) const;
  // Steeper than linear in the variable and in pairs: a defect. A tenth is allowed for noise.
  bool is_steep() const;
};

// For every registered method (not its variants). A point that would take more memory than there is
// is left out, by the memory of the point before.
std::vector<ScalingSweep> run_scaling(const ScalingOptions& options);

Json scaling_to_json(const ScalingOptions& options, const std::vector<ScalingSweep>& sweeps);
std::string scaling_to_text(const ScalingOptions& options, const std::vector<ScalingSweep>& sweeps);

// PNG and the PDF beside it: time and memory against surfels and pixels.
inline constinit Service<void(const fs::path& png, const std::vector<ScalingSweep>& sweeps)>
    draw_scaling{"drawing how steps grow", "use the full build, or --json"};

}  // namespace glint
