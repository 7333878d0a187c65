// SPDX-License-Identifier: MIT
// A program of its own: an interrupt stays seen until the program ends.
#include <csignal>

#include "glint/core/interrupt.h"
#include "tests/reports/run_words.h"
#include "tests/support/small_room.h"

using namespace glint;
using test::run;

TEST_CASE("verbs that are stopped end as their signal says") {
  const test::TempFolder folder;
  const std::string mine = folder / "mine";
  const std::vector<std::string> train = {
      "train",
      "--dataset",
      test::small_room_folder(),
      "--run",
      mine,
      "--iterations",
      "3",
      "--quiet",
      "--data",
      folder / "data"};
  REQUIRE(run(train) == 0);
  install_interrupt_handler();
  std::raise(SIGTERM);
  for (const char* verb : {"render", "mesh"}) CHECK(run({verb, "--run", mine, "--quiet"}) == 143);
  auto again = train;
  again.emplace_back("--force");
  const std::string model = read_file(fs::path(mine) / "interface.ply");
  CHECK(run(again) == 143);
  CHECK(read_file(fs::path(mine) / "interface.ply") == model);  // nothing came of the new one
}
