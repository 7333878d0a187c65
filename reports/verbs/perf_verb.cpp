// SPDX-License-Identifier: MIT
#include <memory>

#include "reports/bench/machine.h"
#include "reports/bench/perf.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

std::string perf_text(const std::vector<PerfRow>& rows) {
  std::vector<std::vector<std::string>> lines{{"op", "threads", "ms", "pairs/s", "x scalar"}};
  for (const PerfRow& row : rows)
    lines.push_back(
        {row.op,
         std::to_string(row.threads),
         fmt::format("{:.3f}", row.ms),
         row.pairs_per_second > 0 ? fmt::format("{:.3g}", row.pairs_per_second) : "–",
         row.ratio_to_scalar > 0 ? fmt::format("{:.1f}", row.ratio_to_scalar) : "–"}
    );
  return aligned_rows(lines);
}

Json perf_json(const PerfOptions& options, const std::vector<PerfRow>& rows) {
  Json json = {
      {"width", options.width},
      {"height", options.height},
      {"surfels", options.surfels},
      {"channels", options.channels},
      {"environment", environment_json()},
      {"rows", Json::array()}};
  for (const PerfRow& row : rows)
    json["rows"].push_back(
        {{"op", row.op},
         {"threads", row.threads},
         {"ms", row.ms},
         {"pairs_per_second", row.pairs_per_second},
         {"ratio_to_scalar", row.ratio_to_scalar}}
    );
  return json;
}

int run_perf_verb(const CommonOptions& common, const PerfOptions& options) {
  const auto rows = run_perf(options);
  if (common.json) {
    print_json(perf_json(options, rows));
    return 0;
  }
  print_text(fmt::format(
      "{}x{} pixels, {} surfels, {} channels, {}\n",
      options.width,
      options.height,
      options.surfels,
      options.channels,
      this_machine().cpu
  ));
  print_text(perf_text(rows));
  return 0;
}

}  // namespace

void add_perf_verb(CommandLine& line) {
  auto options = std::make_shared<PerfOptions>();
  CLI::App* verb = line.add_verb(line.app, "perf", "how fast each op is here", [&line, options] {
    return run_perf_verb(line.common, *options);
  });
  verb->add_option("--width", options->width, "pixels")->capture_default_str();
  verb->add_option("--height", options->height, "pixels")->capture_default_str();
  verb->add_option("--surfels", options->surfels, "how many")
      ->check(CLI::Range(4, 10'000'000))
      ->capture_default_str();
  verb->add_option("--channels", options->channels, "features a surfel")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  verb->add_option("--min-seconds", options->min_seconds, "of each figure")->capture_default_str();
}

}  // namespace glint
