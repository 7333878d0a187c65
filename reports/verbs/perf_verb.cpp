// SPDX-License-Identifier: MIT
#include "glint/core/interrupt.h"
#include "metrics/tools/numeric_options.h"
#include "reports/run/perf/perf.h"
#include "reports/run/perf/scaling.h"
#include "reports/verbs/perf_runs.h"
#include "reports/verbs/single_cell.h"

namespace glint {

namespace {

struct PerfVerb {
  PerfOptions options;
  bool kernels = false;
  std::string scene;    // folder to write to
  std::string scaling;  // folder to write to
  std::vector<std::size_t> scaling_surfels = ScalingOptions().surfels;
  std::vector<std::string> scaling_sizes;  // "160x90"; none: those of ScalingOptions
  FrameRateOptions frame_rates;            // of runs; none: ops are timed
  std::vector<std::string> sizes;          // "480x270"; none: those of FrameRateOptions
};

ImageSize size_of(const char* option, const std::string& text) {
  int width = 0, height = 0, read = 0;
  const int fields = std::sscanf(text.c_str(), "%5dx%5d%n", &width, &height, &read);
  GLINT_CHECK(
      fields == 2 && static_cast<std::size_t>(read) == text.size() && width > 0 && height > 0,
      kUsage,
      "{}: '{}', expected WIDTHxHEIGHT in pixels, such as 160x90",
      option,
      text
  );
  return {width, height};
}

// Those given, or else what there is.
void take_sizes(
    const char* option, const std::vector<std::string>& given, std::vector<ImageSize>& sizes
) {
  if (!given.empty()) sizes.clear();
  for (const std::string& text : given) sizes.push_back(size_of(option, text));
}

// The folder gets scaling.json, and scaling.png where this build draws.
void run_scaling_verb(const CommonOptions& common, const PerfVerb& verb) {
  ScalingOptions options;
  options.base = verb.options;
  options.surfels = verb.scaling_surfels;
  take_sizes("--scaling-sizes", verb.scaling_sizes, options.sizes);
  const std::vector<ScalingSweep> sweeps = run_scaling(options);
  GLINT_CHECK(!sweeps.empty(), kUsage, "--op '{}': no method has such an id", options.base.only);
  const fs::path folder(verb.scaling);
  const Json json = scaling_to_json(options, sweeps);
  write_file(folder / "scaling.json", json.dump(2) + "\n");
  if (draw_scaling.here()) draw_scaling(folder / "scaling.png", sweeps);
  print_result(common, json, scaling_to_text(options, sweeps));
}

int run_frame_rates(const CommonOptions& common, const PerfVerb& verb) {
  FrameRateOptions options = verb.frame_rates;
  take_sizes("--sizes", verb.sizes, options.sizes);
  install_interrupt_handler();
  try {
    const std::vector<FrameRate> rates = measure_frame_rates(options);
    print_result(common, frame_rates_to_json(options, rates), frame_rates_to_text(options, rates));
    return 0;
  } catch (const Interrupted&) {
    return interrupted_exit();
  }
}

int run(const CommonOptions& common, const PerfVerb& verb) {
  const PerfOptions& options = verb.options;
  if (!verb.frame_rates.runs.empty()) return run_frame_rates(common, verb);
  if (!verb.scaling.empty()) {
    run_scaling_verb(common, verb);
  } else if (!verb.scene.empty()) {
    write_perf_scene(options, verb.scene);
  } else if (verb.kernels) {
    const auto rows = run_kernel_times(options);
    print_result(common, kernels_to_json(options, rows), kernels_to_text(options, rows));
  } else {
    const auto rows = run_perf(options);
    print_result(common, perf_to_json(options, rows), perf_to_text(options, rows));
  }
  return 0;
}

void add_run_options(CLI::App& verb, PerfVerb& chosen) {
  CLI::Option* run = verb.add_option(
      "--run", chosen.frame_rates.runs, "only frames a second of these trained runs (folders)"
  );
  add_moved_dataset_option(verb, chosen.frame_rates.dataset);
  verb.get_option("--dataset")->needs(run);
  verb.add_option("--sizes", chosen.sizes, "of frames; 480x270 and 960x540 if not given")
      ->needs(run);
  verb.add_option("--frames", chosen.frame_rates.timing.frames, "timed, of each run and size")
      ->needs(run)
      ->check(above_zero())
      ->capture_default_str();
}

void add_perf_verb(CommandLine& line) {
  auto chosen = std::make_shared<PerfVerb>();
  PerfOptions* options = &chosen->options;
  CommonOptions& common = line.common;
  CLI::App* verb = line.add_verb(
      line.app,
      "perf",
      "time every op and whole training steps",
      [chosen, &common] { return run(common, *chosen); },
      kDeviceOption | kDeviceMatters | kJsonOption | kQuietOption
  );
  verb->add_option("--width", options->width, "pixels")->check(above_zero());
  verb->add_option("--height", options->height, "pixels")->check(above_zero());
  verb->add_option("--surfels", options->surfels, "surfels of the scene")->check(above_zero());
  verb->add_option("--overlap", options->overlap, "surfels' sigma over half their spacing")
      ->check(above_zero());
  verb->add_option("--runs", options->runs, "runs of each op")->check(above_zero());
  verb->add_option(
      "--op", options->only, "only ops whose name matches a glob, or one of several: '2dgs*|glint*'"
  );
  verb->add_flag("--kernels", chosen->kernels, "time each kernel of the ops");
  verb->add_option(
      "--scaling",
      chosen->scaling,
      "only time steps of every method (or, with --op, of those whose ids match) against surfels "
      "and "
      "pixels; tables and picture into a folder"
  );
  verb->add_option("--scaling-surfels", chosen->scaling_surfels, "surfels of a set")
      ->check(above_zero());
  verb->add_option("--scaling-sizes", chosen->scaling_sizes, "pixels, such as 160x90");
  verb->add_option("--write-scene", chosen->scene, "only write surfels and camera to a folder");
  add_run_options(*verb, *chosen);
}

}  // namespace

GLINT_REGISTER(Verb, {"perf", add_perf_verb})

}  // namespace glint
