// SPDX-License-Identifier: MIT
// Layers across a ray, for closed cases.
#pragma once

#include "tests/support/random_scene.h"

namespace glint::test {

// Parallel to the image plane of small_camera(), on its axis.
inline void add_facing(SurfelArrays& surfels, double depth, double opacity) {
  surfels.add({0, 0, depth}, {5, 5}, {1, 0, 0, 0}, opacity, {1, 1, 1});
}
// Anywhere, with `value` in one channel.
inline void add_facing(
    SurfelArrays& surfels, Vec3d mean, double scale, double opacity, float value
) {
  surfels.channels = 1;
  surfels.add(mean, {scale, scale}, {1, 0, 0, 0}, opacity, {value});
}
// 21 x 21 pixels, focal length 20: the middle pixel's centre looks along the axis.
inline Camera small_camera() {
  Camera camera;
  camera.width = camera.height = 21;
  camera.fx = camera.fy = 20;
  camera.cx = camera.cy = 10.5;
  return camera;
}

}  // namespace glint::test
