// SPDX-License-Identifier: MIT
#include "reports/run/bench/voxel_choice.h"

#include <catch2/catch.hpp>

#include "glint/core/error.h"

using namespace glint;

namespace {

// One camera at the origin that looks along z; bounds with a diagonal of 10 m.
Scene scene_of(int width, double focal, const std::vector<Vec3f>& points) {
  Scene scene;
  View view;
  view.camera.width = width, view.camera.height = width / 2;
  view.camera.fx = view.camera.fy = focal;
  view.camera.cx = 0.5 * width, view.camera.cy = 0.25 * width;
  scene.train = {view};
  scene.points.positions = points;
  scene.bounds_max = {10, 0, 0};
  return scene;
}

}  // namespace

TEST_CASE("a voxel is a pixel at the depth of the points that are seen") {
  // Behind the camera and beside the picture do not count.
  const std::vector<Vec3f> points{{0, 0, 2}, {0, 0, 3}, {0, 0, 4}, {0, 0, -90}, {900, 0, 50}};
  CHECK(choose_voxel(scene_of(120, 100, points)).voxel == Approx(0.03));
  CHECK(choose_voxel(scene_of(480, 400, points)).voxel == Approx(0.0075));
  CHECK(choose_voxel(scene_of(120, 100, points)).why.find("120x60") != std::string::npos);
}

TEST_CASE("without points half the diagonal counts, and limits hold") {
  CHECK(choose_voxel(scene_of(120, 100, {})).voxel == Approx(0.05));
  CHECK(choose_voxel(scene_of(8, 4, {})).voxel == Approx(0.2));         // a 50th of 10 m
  CHECK(choose_voxel(scene_of(8, 100000, {})).voxel == Approx(0.005));  // a 2000th
  CHECK_THROWS_AS(choose_voxel(Scene{}), Error);
}
