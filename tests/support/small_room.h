// SPDX-License-Identifier: MIT
// A path-traced room with glass, 64x36 pixels, made once per test program.
#pragma once

#include "datasets/dataset.h"
#include "datasets/glassroom/glassroom.h"
#include "glint/core/progress.h"
#include "tests/support/temp_folder.h"

namespace glint::test {

inline const Scene& small_room() {
  static const TempFolder folder;
  static const Scene scene = [] {
    set_quiet(true);
    GlassRoomOptions options;
    options.width = 64;
    options.height = 36;
    options.views = 16;
    options.spp = 8;
    make_glassroom(options, folder.path() / "room_1");
    return load_scene(folder.path() / "room_1", {});
  }();
  return scene;
}

}  // namespace glint::test
