// SPDX-License-Identifier: MIT
// Frames a second of trained runs: `perf --run`.
#include "reports/verbs/perf_runs.h"

#include <catch2/catch.hpp>

#include "glint/core/progress.h"
#include "reports/verbs/command_line.h"
#include "tests/support/small_room.h"

using namespace glint;

namespace {

int run(const std::vector<std::string>& words) {
  std::vector<const char*> arguments{"glint-bench"};
  for (const std::string& word : words) arguments.push_back(word.c_str());
  arguments.push_back("--quiet");
  return run_command_line(static_cast<int>(arguments.size()), arguments.data());
}

// A run of the method in the small room, three steps long.
std::string trained(const test::TempFolder& folder, const std::string& method) {
  const std::string path = folder / method;
  REQUIRE(
      run(
          {"train",
           "--dataset",
           test::small_room_folder().string(),
           "--method",
           method,
           "--run",
           path,
           "--iterations",
           "3",
           "--data",
           folder / "data"}
      ) == 0
  );
  return path;
}

}  // namespace

TEST_CASE("frames a second of each run are measured at each size") {
  set_quiet(true);
  const test::TempFolder folder;
  FrameRateOptions options;
  options.runs = {trained(folder, "2dgs"), trained(folder, "glint")};
  options.sizes = {{40, 24}, {16, 16}};
  options.timing = {.frames = 2, .warmup = 1};
  const std::vector<FrameRate> rates = measure_frame_rates(options);
  REQUIRE(rates.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(rates[i].run == options.runs[i / 2]);
    CHECK(rates[i].scene == "room_1");
    CHECK(rates[i].method == (i < 2 ? "2dgs" : "glint"));
    CHECK(rates[i].size == options.sizes[i % 2]);
    CHECK(rates[i].surfels > 0);
    CHECK(rates[i].fps > 0);
  }
  const Json json = frame_rates_to_json(options, rates);
  CHECK(json.at("frames") == 2);
  CHECK_FALSE(json.at("device").get<std::string>().empty());
  CHECK(json.at("rows").at(3).at("width") == 16);
  CHECK(json.at("rows").at(3).at("fps") == rates[3].fps);
  const std::string text = frame_rates_to_text(options, rates);
  CHECK_THAT(text, Catch::Contains("glint") && Catch::Contains("40x24"));
}

TEST_CASE("perf --run takes sizes and moved data, and refuses what is no run or no size") {
  const test::TempFolder folder;
  const std::string mine = trained(folder, "2dgs");
  const std::string room = test::small_room_folder().string();
  CHECK(run({"perf", "--run", mine, "--dataset", room, "--sizes", "32x18", "--frames", "1"}) == 0);
  CHECK(run({"perf", "--run", mine, "--sizes", "wide"}) == 1);
  CHECK(run({"perf", "--sizes", "32x18"}) != 0);  // of runs only
  CHECK(run({"perf", "--run", folder / "none", "--sizes", "32x18"}) == 2);
}
