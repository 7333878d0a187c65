// SPDX-License-Identifier: MIT
// A program of its own: an interrupt stays seen until the program ends.
#include "glint/core/interrupt.h"

#include <catch2/catch.hpp>

#include <csignal>

#include "glint/core/progress.h"
#include "reports/run/bench/runner.h"
#include "tests/reports/fake_method.h"
#include "tests/support/temp_folder.h"

using namespace glint;

TEST_CASE("Ctrl-C ends a run after what is finished, and an unfinished cell leaves no record") {
  const test::TempFolder folder;
  register_fake_methods();
  set_quiet(true);
  install_interrupt_handler();
  RunnerOptions options;
  options.profile.name = "fake";
  options.profile.iterations = 3;
  options.profile.methods = {"fake"};
  options.profile.scenes = {
      {{"scene", "room_1"}, {"folder", "a"}}, {{"scene", "room_2"}, {"folder", "b"}}};
  options.out = folder.path();
  options.identify = fake_identity;
  options.load = [](const SceneSource& source) {
    if (source.scene == "room_2") std::raise(SIGINT);
    return LoadedScene{fake_scene(source.scene), "nowhere"};
  };
  const RunSummary summary = run_profile(options);
  CHECK(summary.interrupted);
  CHECK(interrupted_exit() == 130);
  CHECK(summary.ran == 1);
  CHECK(summary.failed == 0);
  const auto records = read_records(folder.path() / "records.jsonl");
  REQUIRE(records.size() == 1);
  CHECK(records[0].cell.scene == "room_1");
}
