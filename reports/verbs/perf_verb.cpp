// SPDX-License-Identifier: MIT
#include "reports/perf/perf.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

template <class Row>
void print_rows(
    const CommonOptions& common,
    const PerfOptions& options,
    const std::vector<Row>& rows,
    Json (*to_json)(const PerfOptions&, const std::vector<Row>&),
    std::string (*to_text)(const PerfOptions&, const std::vector<Row>&)
) {
  if (common.json)
    print_json(to_json(options, rows));
  else
    print_text(to_text(options, rows));
}

struct PerfVerb {
  PerfOptions options;
  bool kernels = false;
  std::string scene;  // folder to write to
};

int run(const CommonOptions& common, const PerfVerb& verb) {
  const PerfOptions& options = verb.options;
  if (!verb.scene.empty())
    write_perf_scene(options, verb.scene);
  else if (verb.kernels)
    print_rows(common, options, run_kernel_times(options), kernels_to_json, kernels_to_text);
  else
    print_rows(common, options, run_perf(options), perf_to_json, perf_to_text);
  return 0;
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
  verb->add_option("--width", options->width, "pixels")->check(CLI::PositiveNumber);
  verb->add_option("--height", options->height, "pixels")->check(CLI::PositiveNumber);
  verb->add_option("--surfels", options->surfels, "surfels of the scene")
      ->check(CLI::PositiveNumber);
  verb->add_option("--overlap", options->overlap, "surfels' sigma over half their spacing")
      ->check(CLI::PositiveNumber);
  verb->add_option("--runs", options->runs, "runs of each op")->check(CLI::PositiveNumber);
  verb->add_option(
      "--op", options->only, "only ops whose name matches a glob, or one of several: '2dgs*|glint*'"
  );
  verb->add_flag("--kernels", chosen->kernels, "time each kernel of the ops");
  verb->add_option("--write-scene", chosen->scene, "only write surfels and camera to a folder");
}

}  // namespace

GLINT_REGISTER(Verb, {"perf", add_perf_verb})

}  // namespace glint
