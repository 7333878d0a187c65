// SPDX-License-Identifier: MIT
#include "metrics/mesh/triangle_tree.h"

#include <catch2/catch.hpp>

#include "glint/core/rng.h"
#include "metrics/mesh/point_tree.h"
#include "metrics/mesh/triangle.h"
#include "tests/metrics/mesh/cgal_distance.h"
#include "tests/metrics/mesh/shapes.h"

using namespace glint;
using namespace glint::test;

namespace {

// Triangles of all shapes and sizes in [-1, 1]^3.
TriangleMesh triangle_soup(int count) {
  TriangleMesh mesh;
  Rng rng(7);
  for (int i = 0; i < count; ++i) {
    const Vec3f center{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
    const float size = rng.uniform(0.001f, 0.2f);
    for (int k = 0; k < 3; ++k)
      mesh.vertices.push_back(center + size * Vec3f{rng.normal(), rng.normal(), rng.normal()});
    mesh.faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

std::vector<Vec3f> random_points(int count, float extent) {
  std::vector<Vec3f> points;
  Rng rng(11);
  for (int i = 0; i < count; ++i)
    points.push_back(
        {rng.uniform(-extent, extent), rng.uniform(-extent, extent), rng.uniform(-extent, extent)}
    );
  return points;
}

}  // namespace

TEST_CASE("distances to triangles equal those of CGAL's AABB tree, near and far") {
  const TriangleMesh mesh = triangle_soup(5000);
  const TriangleTree tree(mesh);
  for (const float extent : {1.0f, 20.0f}) {
    const std::vector<Vec3f> points = random_points(3000, extent);
    const std::vector<double> expected = cgal_distances(mesh, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Nearest nearest = tree.nearest(points[i]);
      REQUIRE(nearest.distance == Approx(expected[i]).margin(1e-12).epsilon(1e-9));
      const Corners corners = corners_of(mesh, static_cast<std::size_t>(nearest.id));
      CHECK(std::sqrt(squared_distance(cast<double>(points[i]), corners)) == nearest.distance);
    }
  }
}

TEST_CASE("a triangle without an area is its edges, and of one place that place") {
  const Corners line{{{0, 0, 0}, {4, 0, 0}, {1, 0, 0}}}, place{{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};
  CHECK(squared_distance({2, 3, 0}, line) == 9);
  CHECK(squared_distance({6, 0, 0}, line) == 4);
  CHECK(squared_distance({1, 1, 3}, place) == 4);
}

TEST_CASE("a point's nearest place is a corner, an edge or the inside of a triangle") {
  const Corners corners{{{0, 0, 0}, {4, 0, 0}, {0, 3, 0}}};
  const auto distance = [&](Vec3d point) { return std::sqrt(squared_distance(point, corners)); };
  CHECK(distance({1, 1, 2}) == Approx(2));
  CHECK(distance({1, 1, 0}) == 0);
  CHECK(distance({-3, -4, 0}) == Approx(5));          // corner
  CHECK(distance({2, -3, 4}) == Approx(5));           // edge a b
  CHECK(distance({2 + 3, 1.5 + 4, 0}) == Approx(5));  // edge b c, along its normal (3, 4)
  CHECK(distance({-1, 2, 0}) == Approx(1));           // edge c a
}

TEST_CASE("a guess changes nothing but the way to the nearest face") {
  const TriangleMesh mesh = cube({0, 0, 0}, 1, 6);
  const TriangleTree tree(mesh);
  Rng rng(3);
  for (const Vec3f point : random_points(500, 2)) {
    const Nearest plain = tree.nearest(point);
    const auto guess =
        static_cast<std::int32_t>(rng.below(static_cast<std::uint32_t>(mesh.faces.size())));
    const Nearest guessed = tree.nearest(point, std::numeric_limits<double>::infinity(), guess);
    CHECK(guessed.id == plain.id);
    CHECK(guessed.distance == plain.distance);
  }
}

TEST_CASE("of faces as near the first is taken") {
  const TriangleMesh mesh = parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, 2);
  // Above the common corner of all faces but two.
  CHECK(TriangleTree(mesh).nearest({0.5f, 0.5f, 1}).id == 0);
}

TEST_CASE("faces at or beyond the largest distance are none") {
  const TriangleMesh mesh = unit_square(0);
  const TriangleTree tree(mesh);
  CHECK(tree.nearest({0.5f, 0.25f, 2}, 2).id == -1);
  CHECK(tree.nearest({0.5f, 0.25f, 2}, 2).distance == 2);
  CHECK(tree.nearest({0.5f, 0.25f, 2}, 2.01).id == 0);
  const std::vector<Vec3f> points{{0, 0, 0}, {1, 0, 0}};
  const PointTree point_tree(points);
  CHECK(point_tree.nearest({3, 0, 0}, 2).id == -1);
  CHECK(point_tree.nearest({3, 0, 0}, 2.5).id == 1);
  CHECK(point_tree.nearest({3, 0, 0}).distance == 2);
}

TEST_CASE("a ray is blocked by what stands before its end, from either side") {
  const TriangleMesh mesh = unit_square(0);
  const TriangleTree tree(mesh);
  CHECK(tree.is_blocked({0.3f, 0.4f, 1}, {0, 0, -1}, 1.5f));
  CHECK(tree.is_blocked({0.3f, 0.4f, -1}, {0, 0, 1}, 1.5f));
  CHECK_FALSE(tree.is_blocked({0.3f, 0.4f, 1}, {0, 0, -1}, 0.5f));
  CHECK_FALSE(tree.is_blocked({1.3f, 0.4f, 1}, {0, 0, -1}, 1.5f));
}

TEST_CASE("the first face of a ray is met in lengths of its direction") {
  TriangleMesh mesh = unit_square(0);
  append(mesh, unit_square(-1));
  const TriangleTree tree(mesh);
  const RayHit above = tree.first_hit({0.3f, 0.4f, 1}, {0, 0, -2});
  CHECK(above.t == Approx(0.5f));
  CHECK(above.face == 1);
  CHECK(tree.first_hit({0.4f, 0.3f, -3}, {0, 0, 1}).t == Approx(2));
  CHECK(tree.first_hit({0.4f, 0.3f, -3}, {0, 0, 1}).face == 2);
  CHECK(tree.first_hit({0.3f, 0.4f, 1}, {0, 0, 1}).face == -1);
  CHECK(tree.first_hit({1.3f, 0.4f, 1}, {0, 0, -1}).face == -1);
}
