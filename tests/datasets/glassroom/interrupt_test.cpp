// SPDX-License-Identifier: MIT
// A program of its own: an interrupt stays seen until the program ends.
#include "glint/core/interrupt.h"

#include <catch2/catch.hpp>

#include <csignal>

#include "datasets/glassroom/glassroom.h"
#include "glint/core/progress.h"
#include "tests/support/temp_folder.h"

using namespace glint;

TEST_CASE("making a scene ends within a picture, and leaves nothing") {
  const test::TempFolder folder;
  set_quiet(true);
  install_interrupt_handler();
  std::raise(SIGTERM);
  const GlassRoomOptions options{.width = 32, .height = 18, .views = 8, .spp = 2};
  CHECK_THROWS_AS(make_glassroom(options, folder / "room", false), Interrupted);
  CHECK(fs::is_empty(folder.path()));
  CHECK(interrupted_exit() == 143);
}
