// SPDX-License-Identifier: MIT
#include "metrics/mesh/cull.h"

#include <catch2/catch.hpp>

#include "glint/core/parallel.h"
#include "metrics/mesh/clean.h"
#include "tests/metrics/mesh/shapes.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

// From `eye` along the six axes, 100 degrees wide: they see all around.
std::vector<Camera> all_around(Vec3d eye) {
  std::vector<Camera> cameras;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      Vec3d target = eye, up{};
      target[axis] += sign;
      up[(axis + 1) % 3] = 1;
      cameras.push_back(look_at(eye, target, up, {64, 64}, 100));
    }
  return cameras;
}

constexpr int kCells = 8;
constexpr std::size_t kCubeFaces = 12 * kCells * kCells;

// A cube of half width 1 in one of half width 2, faces in that order.
TriangleMesh box_in_box() {
  TriangleMesh mesh = cube({0, 0, 0}, 1, kCells);
  append(mesh, cube({0, 0, 0}, 2, kCells));
  return mesh;
}

// The largest coordinate of all vertices that faces use.
float extent(const TriangleMesh& mesh) {
  float largest = 0;
  for (const Vec3f& v : mesh.vertices)
    for (int i = 0; i < 3; ++i) largest = std::max(largest, std::abs(v[i]));
  return largest;
}

}  // namespace

TEST_CASE("cameras in the inner of two boxes see all of it and nothing of the outer") {
  const CulledMesh culled = cull_unseen(box_in_box(), all_around({0.1, 0.2, -0.1}), 0.02, 0);
  CHECK(culled.mesh.faces.size() == kCubeFaces);
  CHECK(extent(culled.mesh) == 1);
  CHECK(culled.recipe.faces_before == 2 * kCubeFaces);
  CHECK(culled.recipe.faces_after == kCubeFaces);
  CHECK(culled.recipe.num_cameras == 6);
  CHECK(culled.recipe.area_before_m2 == Approx(24 + 96));
  CHECK(culled.recipe.area_after_m2 == Approx(24));
}

TEST_CASE("from between two boxes the far side of the inner one is hidden") {
  // All of the outer box but the part in the shadow of the inner one, whose face x = 1 alone faces
  // the cameras at x = 1.5.
  const CulledMesh culled = cull_unseen(box_in_box(), all_around({1.5, 0, 0}), 0.02, 0);
  std::size_t of_inner = 0;
  for (const Triangle& face : culled.mesh.faces) {
    bool inside = true;
    for (const std::int32_t id : face)
      for (int i = 0; i < 3; ++i)
        inside = inside && std::abs(culled.mesh.vertices[static_cast<std::size_t>(id)][i]) <= 1;
    of_inner += inside;
  }
  CHECK(of_inner == kCubeFaces / 6);
  CHECK(culled.mesh.faces.size() < kCubeFaces + kCubeFaces / 6);
  CHECK(culled.mesh.faces.size() > kCubeFaces / 2);
}

TEST_CASE("what lies behind by less than the tolerance is not hidden") {
  TriangleMesh walls = parallelogram({-1, -1, 2}, {2, 0, 0}, {0, 2, 0}, 4, 4);
  append(walls, parallelogram({-1, -1, 2.01f}, {2, 0, 0}, {0, 2, 0}, 4, 4));
  const std::vector<Camera> cameras{look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, {64, 64}, 100)};
  CHECK(cull_unseen(walls, cameras, 0.02, 0).mesh.faces.size() == 64);
  CHECK(cull_unseen(walls, cameras, 0.005, 0).mesh.faces.size() == 32);
  CHECK(extent(cull_unseen(walls, cameras, 0.005, 0).mesh) == 2);
}

TEST_CASE("faces behind a camera or beside its image are not seen") {
  TriangleMesh walls = parallelogram({-1, -1, -2}, {2, 0, 0}, {0, 2, 0});
  append(walls, parallelogram({9, -1, 2}, {2, 0, 0}, {0, 2, 0}));
  const std::vector<Camera> cameras{look_at({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, {64, 64}, 90)};
  const CulledMesh culled = cull_unseen(walls, cameras, 0.02, 0);
  CHECK(culled.mesh.faces.empty());
  CHECK(culled.mesh.vertices.empty());
  CHECK(culled.recipe.faces_after == 0);
  CHECK(cull_unseen(walls, {}, 0.02, 0).mesh.faces.empty());
  CHECK(cull_unseen({}, cameras, 0.02, 0).mesh.faces.empty());
}

TEST_CASE("the order of the cameras and the number of threads decide nothing") {
  const TriangleMesh mesh = box_in_box();
  std::vector<Camera> cameras = all_around({1.5, 0.3, -0.2});
  const std::vector<Camera> others = all_around({-1.4, -1.4, 1.4});
  cameras.insert(cameras.end(), others.begin(), others.end());
  set_num_threads(1);
  const CulledMesh one = cull_unseen(mesh, cameras, 0.02, 0);
  set_num_threads(2);
  const CulledMesh two = cull_unseen(mesh, cameras, 0.02, 0);
  set_num_threads(0);
  CHECK(one.mesh.faces == two.mesh.faces);
  const std::vector<Camera> reversed(cameras.rbegin(), cameras.rend());
  CHECK(cull_unseen(mesh, reversed, 0.02, 0).mesh.faces == one.mesh.faces);
}

TEST_CASE("a tolerance below 0 is an error") {
  error_of(ExitCode::kUsage, [] { cull_unseen(unit_square(0), {}, -0.01, 0); });
}

TEST_CASE("a wall of two triangles is kept where it is seen") {
  // A corner of a wall is inside the image, no centroid of its two triangles is.
  const TriangleMesh wall = parallelogram({0, 0, 2}, {8, 0, 0}, {0, 8, 0});
  const std::vector<Camera> cameras{look_at({1, 1, 0}, {1, 1, 1}, {0, 1, 0}, {64, 64}, 90)};
  CHECK(cull_unseen(wall, cameras, 0.02, 0).mesh.faces.empty());
  const CulledMesh culled = cull_unseen(wall, cameras, 0.02, 0.2);
  CHECK(culled.recipe.faces_before == 2);
  CHECK(culled.recipe.faces_split == 2 * 57 * 57);  // diagonal 8 sqrt(2) m in parts of 0.2 m
  // The image meets [0, 3] x [0, 3] m of it; cells on the outline by their centroid.
  CHECK(culled.recipe.area_after_m2 == Approx(9).margin(2 * 3 * 8.0 / 57));
}

TEST_CASE("splitting keeps area, orientation and short faces") {
  TriangleMesh mesh = unit_square(0);
  append(mesh, parallelogram({5, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}));
  const TriangleMesh split = split_long_faces(mesh, 0.3);
  CHECK(split.faces.size() == 2 * 5 * 5 + 2);
  CHECK(surface_area(split) == Approx(1.01));
  for (const Vec3f& normal : face_normals(split)) CHECK(normal.z == Approx(1));
  CHECK(split_long_faces(unit_square(0), 1e-9).faces.size() == 2 * 64 * 64);
}

TEST_CASE("a mesh that would be split into more faces than one can hold is refused before that") {
  const TriangleMesh mesh = parallelogram({0, 0, 0}, {4, 0, 0}, {0, 3, 0}, 200, 200);
  CHECK_THROWS_WITH(
      split_long_faces(mesh, 1e-9), Catch::Contains("with max_edge_m (--max-edge) 1e-09")
  );
  CHECK_NOTHROW(split_long_faces(unit_square(0), 1e-9));  // 64 parts of an edge at most
}
