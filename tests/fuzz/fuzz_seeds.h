// SPDX-License-Identifier: MIT
// Small valid files that several targets begin with.
#pragma once

#include <string>
#include <string_view>

#include "glint/scene/scene.h"

namespace glint::fuzz {

// Two views of 3 x 2 pixels, four points.
inline Scene tiny_scene() {
  Scene scene;
  scene.name = "tiny";
  scene.dataset = "made";
  scene.spec_hash = "abc";
  for (int i = 0; i < 2; ++i) {
    View view;
    view.name = "000" + std::to_string(i);
    view.camera = {.width = 3, .height = 2, .fx = 3, .fy = 3, .cx = 1.5, .cy = 1};
    view.camera.translation_cam_from_world = {0.1 * i, 0, 0};
    view.rgb = Image(3, 2, 3, 0.5f);
    view.truth["depth"] = Image(3, 2, 1, 2.0f);
    scene.train.push_back(std::move(view));
  }
  scene.points.positions = {{0, 0, 2}, {0.5f, 0, 2}, {0, 0.5f, 2}, {0.5f, 0.5f, 3}};
  scene.points.colors.assign(4, {0.5f, 0.25f, 1});
  set_extent(scene);
  return scene;
}

}  // namespace glint::fuzz
