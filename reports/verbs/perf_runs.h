// SPDX-License-Identifier: MIT
// Frames a second of trained runs at given sizes, side by side: `perf --run`.
#pragma once

#include "reports/run/bench/stages.h"

namespace glint {

struct FrameRateOptions {
  std::vector<std::string> runs;  // their folders
  std::string dataset;            // of all runs; empty: what each was trained on
  std::vector<ImageSize> sizes = {{480, 270}, {960, 540}};  // pixels
  TimingOptions timing;
};

struct FrameRate {
  std::string run, scene, method;
  ImageSize size;           // pixels
  std::size_t surfels = 0;  // of all sets
  double fps = 0;           // as the metric of that name
};

// Every run at every size, in that order: its test cameras (training cameras where there are none)
// with the image size changed and the horizontal field of view kept. Nothing is written. Errors:
// open_single_cell()'s, load_trained()'s; kBadReference: no cameras.
std::vector<FrameRate> measure_frame_rates(const FrameRateOptions& options);

Json frame_rates_to_json(const FrameRateOptions& options, const std::vector<FrameRate>& rates);
std::string frame_rates_to_text(
    const FrameRateOptions& options, const std::vector<FrameRate>& rates
);

}  // namespace glint
