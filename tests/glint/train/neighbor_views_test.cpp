// SPDX-License-Identifier: MIT
#include "glint/train/neighbor_views.h"

#include <catch2/catch.hpp>

using namespace glint;

namespace {

// A camera at x metres along a line that looks `degrees` off the y axis.
View view_at(double x, double degrees = 0) {
  const double a = degrees * M_PI / 180;
  const Vec3d eye{x, 0, 0};
  View view;
  view.camera = look_at(eye, eye + Vec3d{std::sin(a), std::cos(a), 0}, {0, 0, 1}, {8, 6}, 60);
  return view;
}

using Neighbors = std::vector<std::size_t>;

}  // namespace

TEST_CASE("Neighbours are the nearest views first, ties by index") {
  const std::vector<View> views{view_at(0), view_at(1), view_at(0.25), view_at(-0.25)};
  const auto neighbors = neighbor_views(views, {}, 1);
  CHECK(neighbors[0] == Neighbors{2, 3, 1});
  CHECK(neighbors[1] == Neighbors{2, 0, 3});
}

TEST_CASE("Views that are too far, too near or look elsewhere are no neighbours") {
  const std::vector<View> views{
      view_at(0), view_at(2), view_at(0.001), view_at(0.1, 35), view_at(0.2, 25)};
  CHECK(neighbor_views(views, {}, 1)[0] == Neighbors{4});
  CHECK(neighbor_views(views, {}, 2)[0] == Neighbors{4, 1});  // distances scale with the scene
}

TEST_CASE("There are at most so many neighbours, and none of a view alone") {
  std::vector<View> views;
  for (int i = 0; i < 12; ++i) views.push_back(view_at(0.1 * i));
  NeighborConfig config;
  CHECK(neighbor_views(views, config, 1)[0].size() == 8);
  config.count = 3;
  CHECK(neighbor_views(views, config, 1)[0] == Neighbors{1, 2, 3});
  views.resize(1);
  CHECK(neighbor_views(views, config, 1)[0].empty());
}
