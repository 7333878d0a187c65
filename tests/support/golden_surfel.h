// SPDX-License-Identifier: MIT
// One surfel, one camera, one image point, and what the formulas of [Huang24] give there; computed
// in float64 apart from this program, derivatives confirmed by finite differences.
#pragma once

#include <array>

#include "tests/support/random_scene.h"
#include "tests/support/reference_render.h"

namespace glint::test {

inline Camera golden_camera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 500;
  camera.fy = 480;
  camera.cx = 320;
  camera.cy = 240;
  return camera;
}

inline constexpr Vec2d kGoldenPoint{352.5, 230.5};  // the centre of pixel (352, 230)

inline SurfelArrays golden_surfel() {
  SurfelArrays surfels;
  surfels.channels = 1;
  surfels.add({0.2, -0.1, 4}, {0.3, 0.15}, {0.9, 0.2, -0.3, 0.1}, 0.8, {1.0f});
  return surfels;
}

// The same without rounding to float.
inline ReferenceInput golden_reference_input() {
  ReferenceInput input;
  input.count = 1;
  input.channels = 1;
  input.means = {0.2, -0.1, 4};
  input.scales = {0.3, 0.15};
  input.rotations = {0.9, 0.2, -0.3, 0.1};
  input.opacities = {0.8};
  input.features = {1};
  return input;
}

struct GoldenGradient {
  std::array<double, 3> mean;
  std::array<double, 4> rotation;  // of the quaternion as given, not normalised
  std::array<double, 2> scale;
};

inline constexpr GoldenGradient kGoldenRho3{
    {-2.3379078, -2.4360598, 0.1037503},
    {-0.1276467, 0.1733887, -0.3466727, -0.2379757},
    {-0.5623485, -0.1488079}};
inline constexpr GoldenGradient kGoldenDepth{
    {-0.7509622, -0.6308082, 1.0363278}, {-0.0880381, 0.0690132, -0.2307938, -0.0380651}, {0, 0}};
inline constexpr GoldenGradient kGoldenRho2{
    {-9589.8053161, -2671.9754015, -53.411982},
    {-222.1606948, -360.7078951, -790.4392574, 349.5442712},
    {6288.7103786, -148.0110842}};

}  // namespace glint::test
