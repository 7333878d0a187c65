// SPDX-License-Identifier: MIT
// As many surfels and pixels as a training step has, for tests of GPU backends at scale.
#pragma once

#include "tests/support/random_scene.h"

namespace glint::test {

inline constexpr ImageSize kLargeSize{480, 270};
inline constexpr std::size_t kManySurfels = 100'000;

struct LargeScene {
  Camera camera;
  SurfelArrays arrays;
};

// Sizes on the screen as trained ones have; a few of every awkward kind.
inline LargeScene large_scene(double max_opacity = 1, std::size_t count = kManySurfels) {
  Rng rng(2024);
  LargeScene scene;
  scene.camera = random_camera(rng, kLargeSize);
  RandomSurfels options;
  options.count = count;
  options.max_opacity = max_opacity;
  options.min_sigma_px = 0.3;
  options.max_sigma_px = 6;
  options.edge_on = options.behind = options.tiny = 0.02;
  options.at_camera = options.huge = 0.0005;
  scene.arrays = random_surfels(options, scene.camera, rng);
  return scene;
}

}  // namespace glint::test
