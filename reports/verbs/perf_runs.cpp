// SPDX-License-Identifier: MIT
#include "reports/verbs/perf_runs.h"

#include "glint/core/device.h"
#include "glint/core/interrupt.h"
#include "glint/core/machine.h"
#include "glint/core/progress.h"
#include "glint/core/rows.h"
#include "glint/scene/camera_path.h"
#include "reports/verbs/single_cell.h"

namespace glint {

namespace {

// Cameras alone: what measure_fps() looks at.
Scene cameras_at(const Scene& scene, ImageSize size) {
  const std::vector<View>& views = scene.test.empty() ? scene.train : scene.test;
  GLINT_CHECK(!views.empty(), kBadReference, "{}: no cameras", scene.name);
  Scene resized;
  for (const View& view : views) resized.test.emplace_back().camera = with_size(view.camera, size);
  return resized;
}

std::string machine_text() { return on_gpu() ? device_name() : this_machine().cpu; }

Rows rows_of(const std::vector<FrameRate>& rates) {
  Rows rows(
      {{"scene", "scene"},
       {"method", "method"},
       {"", "size", "{}"},
       {"surfels", "surfels", "{}"},
       {"fps", "fps", "{:.1f}"}},
      "run width height"
  );
  for (const auto& [run, scene, method, size, surfels, fps] : rates) {
    const std::string size_text = fmt::format("{}x{}", size.width, size.height);
    rows.add({scene, method, size_text, surfels, fps, run, size.width, size.height});
  }
  return rows;
}

}  // namespace

std::vector<FrameRate> measure_frame_rates(const FrameRateOptions& options) {
  std::vector<FrameRate> rates;
  Progress progress("perf", options.runs.size() * options.sizes.size());
  for (const std::string& run : options.runs) {
    const SingleCell single = open_single_cell(run, options.dataset);
    const auto method = load_trained(single.spec);
    const CellKey cell = single.spec.cell();
    for (const ImageSize size : options.sizes) {
      throw_if_interrupted();
      const double fps = measure_fps(*method, cameras_at(single.scene, size), options.timing);
      rates.push_back({run, cell.scene, cell.method, size, method->num_surfels(), fps});
      progress.advance(1, cell.text());
    }
  }
  return rates;
}

Json frame_rates_to_json(const FrameRateOptions& options, const std::vector<FrameRate>& rates) {
  return {
      {"cpu", this_machine().cpu},
      {"device", device_name()},
      {"frames", options.timing.frames},
      {"warmup", options.timing.warmup},
      {"rows", rows_of(rates).json()}};
}

std::string frame_rates_to_text(
    const FrameRateOptions& options, const std::vector<FrameRate>& rates
) {
  return fmt::format(
             "frames a second, {} frames each, {}\n", options.timing.frames, machine_text()
         ) +
         rows_of(rates).text();
}

}  // namespace glint
