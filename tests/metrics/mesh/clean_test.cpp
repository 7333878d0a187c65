// SPDX-License-Identifier: MIT
#include "metrics/mesh/clean.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/metrics/mesh/shapes.h"

using namespace glint;
using namespace glint::test;

TEST_CASE("a clean mesh keeps its faces") {
  const TriangleMesh mesh = cube({1, 2, 3}, 1, 3);
  const CleanMesh clean = clean_mesh(mesh);
  CHECK(clean.mesh.faces.size() == mesh.faces.size());
  CHECK(clean.report.faces_after == clean.report.faces_before);
  CHECK(clean.report.non_manifold_edges == 0);
  CHECK(surface_area(clean.mesh) == Approx(24));
}

TEST_CASE("faces with a corner that is not finite are dropped and counted") {
  TriangleMesh mesh = parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, 1);
  mesh.vertices[0].y = std::nanf("");  // of both faces of the first cell
  mesh.vertices.push_back({INFINITY, 0, 0});
  mesh.faces.push_back({1, 2, 6});
  const CleanMesh clean = clean_mesh(mesh);
  CHECK(clean.report.not_finite == 3);
  CHECK(clean.report.faces_after == 2);
  CHECK(clean.mesh.vertices.size() == 4);
  CHECK(surface_area(clean.mesh) == Approx(0.5));
}

TEST_CASE("faces without area are dropped and counted") {
  TriangleMesh mesh = unit_square(0);
  mesh.vertices.push_back({0.5f, 0, 0});  // on an edge
  mesh.vertices.push_back({1, 0, 0});     // where vertex 1 is
  mesh.faces.push_back({0, 1, 4});
  mesh.faces.push_back({0, 1, 1});
  mesh.faces.push_back({0, 1, 5});
  const CleanMesh clean = clean_mesh(mesh);
  CHECK(clean.report.zero_area == 3);
  CHECK(clean.report.faces_after == 2);
}

TEST_CASE("a thin face is not one without area") {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {10, 0, 0}, {5, 1e-4f, 0}};
  mesh.faces = {{0, 1, 2}};
  CHECK(clean_mesh(mesh).report.faces_after == 1);
}

TEST_CASE("a face stored again is dropped, whatever its winding and vertices' ids") {
  TriangleMesh mesh = unit_square(0);
  mesh.faces.push_back({1, 3, 0});   // turned
  mesh.faces.push_back({0, 3, 1});   // wound the other way
  append(mesh, unit_square(-0.0f));  // vertices of its own at the same places
  const CleanMesh clean = clean_mesh(mesh);
  CHECK(clean.report.duplicate == 4);
  CHECK(clean.report.faces_after == 2);
  CHECK(clean.mesh.vertices.size() == 4);
  CHECK(surface_area(clean.mesh) == Approx(1));
}

TEST_CASE("edges of more than two faces are counted and kept") {
  TriangleMesh mesh = unit_square(0);
  append(mesh, parallelogram({0, 0, 0}, {1, 0, 0}, {0, 0, 1}));   // a fin on the edge y = 0
  append(mesh, parallelogram({0, 0, 0}, {1, 0, 0}, {0, 0, -1}));  // and one below
  const CleanMesh clean = clean_mesh(mesh);
  CHECK(clean.report.non_manifold_edges == 1);
  CHECK(clean.report.faces_after == 6);
}

TEST_CASE("selected faces keep their order, corners and colours") {
  TriangleMesh mesh = unit_square(0);
  mesh.colors = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const TriangleMesh second = select_faces(mesh, std::vector<std::uint8_t>{0, 1});
  REQUIRE(second.faces.size() == 1);
  CHECK(second.vertices.size() == 3);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto from = static_cast<std::size_t>(mesh.faces[1][k]);
    const auto to = static_cast<std::size_t>(second.faces[0][k]);
    CHECK(length(second.vertices[to] - mesh.vertices[from]) == 0);
    CHECK(length(second.colors[to] - mesh.colors[from]) == 0);
  }
}
