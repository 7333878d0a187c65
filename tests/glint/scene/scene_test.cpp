// SPDX-License-Identifier: MIT
#include "glint/scene/scene.h"

#include <catch2/catch.hpp>

using namespace glint;

namespace {

View view_at(Vec3d eye, Vec3d target) {
  View view;
  view.camera = look_at(eye, target, {0, 0, 1}, {40, 30}, 60);
  return view;
}

}  // namespace

TEST_CASE("the camera extent is 1.1 times the largest distance to the mean centre") {
  std::vector<View> views{
      view_at({1, 0, 0}, {0, 5, 0}), view_at({-1, 0, 0}, {0, 5, 0}), view_at({0, 3, 0}, {0, 5, 0})};
  // The mean is (0, 1, 0); (0, 3, 0) lies 2 away.
  CHECK(camera_extent(views) == Approx(2.2f));
  CHECK(camera_extent({}) == 0);
}

TEST_CASE("bounds are the 0.5 and 99.5 percentiles of the points") {
  Scene scene;
  scene.train = {view_at({0, 0, 0}, {1, 0, 0})};
  for (int i = 0; i <= 1000; ++i)
    scene.points.positions.push_back({static_cast<float>(i), static_cast<float>(-i), 7});
  set_extent(scene);
  CHECK(scene.bounds_min.x == Approx(5));
  CHECK(scene.bounds_max.x == Approx(995));
  CHECK(scene.bounds_min.y == Approx(-995));
  CHECK(scene.bounds_max.z == 7);
  CHECK(scene.spatial_scale == 1);  // one camera has no extent
}

TEST_CASE("without points the bounds hold the cameras and what they look at") {
  Scene scene;
  scene.train = {view_at({1, 0, 0}, {1, 9, 0}), view_at({-1, 0, 0}, {-1, 9, 0})};
  set_extent(scene);
  CHECK(scene.spatial_scale == Approx(1.1f));
  CHECK(scene.bounds_min.x == Approx(-1));
  CHECK(scene.bounds_max.x == Approx(1));
  CHECK(scene.bounds_min.y == Approx(0).margin(1e-6));
  CHECK(scene.bounds_max.y == Approx(2.2f));
}
