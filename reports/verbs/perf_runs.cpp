// SPDX-License-Identifier: MIT
#include "reports/verbs/perf_runs.h"

#include "glint/core/device.h"
#include "glint/core/interrupt.h"
#include "glint/core/machine.h"
#include "glint/core/progress.h"
#include "glint/scene/camera_path.h"
#include "reports/verbs/single_run.h"

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

}  // namespace

std::vector<FrameRate> measure_frame_rates(const FrameRateOptions& options) {
  std::vector<FrameRate> rates;
  Progress progress("perf", options.runs.size() * options.sizes.size());
  for (const std::string& run : options.runs) {
    const SingleRun single = open_single_run(run, options.dataset);
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
  Json json = {
      {"cpu", this_machine().cpu},
      {"device", device_name()},
      {"frames", options.timing.frames},
      {"warmup", options.timing.warmup},
      {"rows", Json::array()}};
  for (const FrameRate& rate : rates)
    json["rows"].push_back(
        {{"run", rate.run},
         {"scene", rate.scene},
         {"method", rate.method},
         {"width", rate.size.width},
         {"height", rate.size.height},
         {"surfels", rate.surfels},
         {"fps", rate.fps}}
    );
  return json;
}

std::string frame_rates_to_text(
    const FrameRateOptions& options, const std::vector<FrameRate>& rates
) {
  std::string text = fmt::format(
      "frames a second, {} frames each, {}\n{:<16} {:<20} {:>10} {:>10} {:>10}\n",
      options.timing.frames,
      machine_text(),
      "scene",
      "method",
      "size",
      "surfels",
      "fps"
  );
  for (const FrameRate& rate : rates)
    text += fmt::format(
        "{:<16} {:<20} {:>10} {:>10} {:>10.1f}\n",
        rate.scene,
        rate.method,
        fmt::format("{}x{}", rate.size.width, rate.size.height),
        rate.surfels,
        rate.fps
    );
  return text;
}

}  // namespace glint
