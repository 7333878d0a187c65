// SPDX-License-Identifier: MIT
// A path-traced room with glass, 64x36 pixels, made once per test program.
#pragma once

#include "datasets/dataset.h"
#include "datasets/glassroom/glassroom.h"
#include "glint/core/progress.h"
#include "tests/support/temp_folder.h"

namespace glint::test {

inline const fs::path& small_room_folder() {
  static const TempFolder folder;
  static const fs::path room = [] {
    set_quiet(true);
    GlassRoomOptions options;
    options.width = 64;
    options.height = 36;
    options.views = 16;
    options.spp = 8;
    make_glassroom(options, folder.path() / "room_1", false);
    return folder.path() / "room_1";
  }();
  return room;
}

inline const Scene& small_room() {
  static const Scene scene = load_scene(small_room_folder(), {});
  return scene;
}

}  // namespace glint::test
