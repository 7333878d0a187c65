// SPDX-License-Identifier: MIT
#include "glint/train/initial_points.h"

#include <catch2/catch.hpp>

#include "glint/core/error.h"

using namespace glint;

namespace {

Scene scene_of(ImageSize size) {
  Scene scene;
  scene.name = "test";
  View view;
  view.camera = look_at({0, 0, 0}, {0, 0, 1}, {0, -1, 0}, size, 60);
  scene.train = {view};
  scene.bounds_min = {-1, -2, 1};
  scene.bounds_max = {3, 2, 4};
  return scene;
}

}  // namespace

TEST_CASE("The reflection grid has as many points a pixel in small images and 32 cells in large") {
  const ReflectionGrid grid;
  CHECK(grid.cells_for({480, 270}) == 32);
  CHECK(grid.cells_for({1920, 1080}) == 32);
  CHECK(grid.cells_for({160, 90}) == 15);
  CHECK(grid.cells_for({1, 1}) == 1);
  CHECK(grid.coarseness({480, 270}) == 1.0f);
  CHECK(grid.coarseness({160, 90}) == Approx(32.0 / 15));
}

TEST_CASE("Every cell of the reflection grid holds its points, inside the bounds") {
  ReflectionGrid grid;
  grid.cells = 4;
  const Scene scene = scene_of({160, 90});
  const PointCloud points = grid.points(scene, 3);
  REQUIRE(points.positions.size() == 4 * 4 * 4 * 5);
  REQUIRE(points.colors.size() == points.positions.size());
  std::vector<int> in_cell(64);
  for (const Vec3f p : points.positions) {
    const int x = static_cast<int>(p.x + 1), y = static_cast<int>(p.y + 2);
    const int z = static_cast<int>((p.z - 1) / 0.75f);
    REQUIRE((x >= 0 && x < 4 && y >= 0 && y < 4 && z >= 0 && z < 4));
    ++in_cell[static_cast<std::size_t>(x + 4 * (y + 4 * z))];
  }
  for (const int count : in_cell) CHECK(count == 5);
  CHECK(grid.points(scene, 3).positions.front().x == points.positions.front().x);
  CHECK(grid.points(scene, 4).positions.front().x != points.positions.front().x);
}

TEST_CASE("A scene's own points are used, random ones in the bounds where it has none") {
  Scene scene = scene_of({16, 9});
  const PointCloud random = initial_points(scene, 100, 0);
  CHECK(random.positions.size() == 100);
  for (const Vec3f p : random.positions)
    CHECK((p.x >= -1 && p.x <= 3 && p.y >= -2 && p.y <= 2 && p.z >= 1 && p.z <= 4));
  scene.points.positions = {{0, 0, 2}, {0, 0, -2}};
  CHECK(initial_points(scene, 100, 0).positions.size() == 2);
}

TEST_CASE("Points behind all cameras are refused") {
  Scene scene = scene_of({16, 9});
  scene.points.positions = {{0, 0, -2}, {1, 0, -1}};
  CHECK_THROWS_WITH(
      initial_points(scene, 100, 0), Catch::Contains("none of 2 points lies in front of any of 1")
  );
}
