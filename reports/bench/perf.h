// SPDX-License-Identifier: MIT
// How fast each op is: on fixed synthetic surfels, against the scalar instantiation of the same
// text, on one thread and on all.
#pragma once

#include <string>
#include <vector>

namespace glint {

struct PerfOptions {
  int width = 240, height = 135;  // pixels
  int surfels = 20000;
  int channels = 11;         // of the rasteriser's features
  double min_seconds = 0.5;  // each figure is the median of runs that fill this time
};

struct PerfRow {
  std::string op;  // "rasterize forward", "2dgs step", ...
  int threads = 1;
  double ms = 0;                // median
  double pairs_per_second = 0;  // surfel-pixel pairs visited; 0: not counted
  double ratio_to_scalar = 0;   // scalar time / this time, same threads; 0: no scalar variant
};

// Restores the number of threads.
std::vector<PerfRow> run_perf(const PerfOptions& options);

}  // namespace glint
