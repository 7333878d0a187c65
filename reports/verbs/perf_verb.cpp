// SPDX-License-Identifier: MIT
#include "reports/perf/perf.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {
void add_perf_verb(CommandLine& line) {
  auto options = std::make_shared<PerfOptions>();
  CommonOptions& common = line.common;
  CLI::App* verb = line.add_verb(
      line.app,
      "perf",
      "time every op and whole training steps",
      [options, &common] {
        const std::vector<PerfRow> rows = run_perf(*options);
        if (common.json)
          print_json(perf_to_json(*options, rows));
        else
          print_text(perf_to_text(*options, rows));
        return 0;
      },
      kDeviceOption | kDeviceMatters | kJsonOption | kQuietOption
  );
  verb->add_option("--width", options->width, "pixels")->check(CLI::PositiveNumber);
  verb->add_option("--height", options->height, "pixels")->check(CLI::PositiveNumber);
  verb->add_option("--surfels", options->surfels, "surfels of the scene")
      ->check(CLI::PositiveNumber);
  verb->add_option("--overlap", options->overlap, "surfels' sigma over half their spacing")
      ->check(CLI::PositiveNumber);
  verb->add_option("--runs", options->runs, "runs of each op")->check(CLI::PositiveNumber);
  verb->add_option("--op", options->only, "only ops whose name matches a glob");
}
}  // namespace

GLINT_REGISTER(Verb, {"perf", add_perf_verb})

}  // namespace glint
