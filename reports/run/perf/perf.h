// SPDX-License-Identifier: MIT
// Timings of the ops, side by side in one run: SIMD against the scalar instantiation of the same
// text, one thread against two. A file perf/<name>_cases.cpp registers cases.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "glint/core/config.h"
#include "glint/core/device.h"
#include "glint/core/files.h"
#include "glint/core/registry.h"

namespace glint {

struct PerfCase {
  std::string name;
  std::string unit;                  // what `work` counts: "pairs", "surfels", "pixels", "steps"
  std::function<double()> work;      // units of one run; called once after a run
  std::function<void()> run;         // one run
  std::function<void()> run_scalar;  // the same without SIMD; empty: no such instantiation
  // Bytes that one run has to move at least: inputs read once, outputs written once. Empty: not
  // said.
  std::function<double()> bytes = {};
};

struct PerfRow {
  std::string name, unit;
  int threads = 1;
  double ms = 0;                // median of the runs
  double per_second = 0;        // units per second
  double scalar_ratio = 0;      // scalar time / SIMD time, median of pairs; 0: none
  double thread_ratio = 0;      // one thread's time / this; 0 for one thread
  double bytes_per_second = 0;  // of the bytes it has to move; 0: not said
  DeviceCounters asked;         // of the device in a run
};

struct PerfOptions {
  int width = 240, height = 135;  // pixels
  std::size_t surfels = 20000;
  // Sigma of a surfel over half the mean distance of its neighbours. 2.6 puts a pixel into the
  // boxes of about 45 surfels, as in a 2DGS trained on GlassRoom for 1500 steps; 1.5: about 15.
  float overlap = 2.6f;
  int runs = 15;           // of each case, after one warm-up
  std::string only = "*";  // globs over case names, any of them: "2dgs*|glint*"

  bool wants(std::string_view name) const;
};

// Registered with GLINT_REGISTER(PerfCases, {"raster", raster_cases}); run in the order of ids.
// Nothing is made for cases that are not wanted: methods with all their sets take a while.
struct PerfCases {
  std::string id;
  std::vector<PerfCase> (*make)(const PerfOptions& options);
};

// Those that are wanted. Errors (kUsage): none is.
std::vector<PerfCase> make_perf_cases(const PerfOptions& options);

// Every case at 1 and 2 threads (1 only where the machine has one), or on the GPU in use. Runs of
// SIMD and scalar alternate, so a machine that slows down slows both.
std::vector<PerfRow> run_perf(const PerfOptions& options);

// The same cases, once more for each kernel in them, with what is between kernels left out.
struct KernelRow {
  std::string op, kernel;
  double launches = 0;  // of one run
  double ms = 0;        // of one run: by the device's clock, on the CPU by the host's
};
// Of each op, the longest first. On the CPU, rasterising and tracing are no kernels.
std::vector<KernelRow> run_kernel_times(const PerfOptions& options);

// The surfels and cameras that ops are timed on, for other programs to be timed on: surfels.ply
// and camera.json (pixels; cam_from_world: 3x4, by rows) in `folder`.
void write_perf_scene(const PerfOptions& options, const fs::path& folder);

// Seconds of one training step of a method on the scene of the ops, the least of a few after one to
// warm up, and the memory that the method, its scene and its steps take at most, megabytes (10^6
// bytes): the highest less what there was before, of the process or, on a GPU, in use there.
struct StepCost {
  double seconds = 0, memory_mb = 0;
};
StepCost cost_of_step(const std::string& method, const PerfOptions& options);

Json perf_setting(const PerfOptions& options);  // with empty "rows"
Json perf_to_json(const PerfOptions& options, const std::vector<PerfRow>& rows);
std::string perf_to_text(const PerfOptions& options, const std::vector<PerfRow>& rows);
Json kernels_to_json(const PerfOptions& options, const std::vector<KernelRow>& rows);
std::string kernels_to_text(const PerfOptions& options, const std::vector<KernelRow>& rows);

}  // namespace glint
