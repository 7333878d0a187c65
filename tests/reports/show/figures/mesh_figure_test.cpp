// SPDX-License-Identifier: MIT
#include "reports/show/figures/mesh_figure.h"

#include <catch2/catch.hpp>

#include <cmath>

#include "glint/drawing/color_maps.h"
#include "glint/scene/ply.h"
#include "reports/show/figures/mesh_render.h"
#include "tests/metrics/mesh/shapes.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

// Half a step of bytes, and the rounding of hits, some micrometres; 1 mm is 0.01.
constexpr double kColorMargin = 0.5 / 255 + 1e-4;

// At the origin, along z.
Camera small_camera() {
  Camera camera;
  camera.width = 41, camera.height = 31;
  camera.fx = camera.fy = 40;
  camera.cx = 20.5, camera.cy = 15.5;
  return camera;
}

// Larger than what the camera sees of the plane z.
TriangleMesh wall(float z) { return parallelogram({-4, -4, z}, {8, 0, 0}, {0, 8, 0}, 8, 8); }

MeshRender rendered(const TriangleMesh& mesh) { return render_mesh(mesh, small_camera()); }

FigureScene scene_of(const fs::path& folder, const std::vector<std::string>& methods) {
  FigureScene scene;
  scene.name = "room_1";
  scene.view = "0002";
  scene.data = folder / "data";
  scene.camera = small_camera();
  scene.train_cameras = {small_camera()};
  for (const std::string& method : methods) scene.runs[method] = folder / method;
  return scene;
}

float value_at(const Panel& panel, int x, int y, int c) {
  return static_cast<float>(panel.bytes().at(x, y, c)) / 255;
}

void check_color(const Panel& panel, const Image& expected) {
  const int x = panel.size().width / 2 + 3, y = panel.size().height / 2 + 2;
  for (int c = 0; c < 3; ++c)
    CHECK(value_at(panel, x, y, c) == Approx(expected.at(0, 0, c)).margin(kColorMargin));
}

Image color_of(float distance) {
  return colorize_scalar(Image(1, 1, 1, distance), 0, mesh_error_high(), ScalarColors::kMagma);
}

}  // namespace

TEST_CASE("a wall's depth is planar, its shade the cosine of the ray") {
  const MeshRender render = rendered(wall(2));
  for (const int x : {0, 20, 40})
    for (const int y : {0, 15, 30}) {
      const double u = (x - 20) / 40.0, v = (y - 15) / 40.0;
      CHECK(static_cast<double>(render.depth.at(x, y)) == Approx(2));
      CHECK(
          static_cast<double>(render.cosine.at(x, y)) == Approx(1 / std::sqrt(1 + u * u + v * v))
      );
    }
}

TEST_CASE("a sphere is met where its equation says, its normal is radial") {
  TriangleMesh mesh = sphere(1, 200);
  for (Vec3f& vertex : mesh.vertices) vertex.z += 4;
  const MeshRender render = rendered(mesh);
  CHECK(render.depth.at(0, 0) == 0);  // beside it
  CHECK(render.cosine.at(0, 0) == 0);
  for (const int x : {21, 24, 28}) {
    // |t d - c|^2 = 1 with d = (u, v, 1), c = (0, 0, 4); planar depth is t.
    const double u = (x - 20) / 40.0, v = -0.05, uv = u * u + v * v, dd = 1 + uv;
    const double t = (4 - std::sqrt(16 - 15 * dd)) / dd;
    const double cosine = std::abs(t * uv + t - 4) / std::sqrt(dd);
    CHECK(static_cast<double>(render.depth.at(x, 13)) == Approx(t).epsilon(1e-3));
    CHECK(static_cast<double>(render.cosine.at(x, 13)) == Approx(cosine).epsilon(0.02));
  }
}

TEST_CASE("either side of a face is shaded alike, and nothing is grey") {
  TriangleMesh mesh = parallelogram({0, -4, 2}, {8, 0, 0}, {0, 8, 0});
  const Image front = shaded_picture(rendered(mesh));
  for (Triangle& face : mesh.faces) std::swap(face[1], face[2]);
  const Image back = shaded_picture(rendered(mesh));
  CHECK(front.at(30, 15) == back.at(30, 15));
  CHECK(front.at(30, 15) > 0.8f);
  CHECK(front.at(5, 15) == kNothingGrey);
  CHECK(shaded_picture(rendered({})).at(30, 15) == kNothingGrey);
}

TEST_CASE("a displaced wall has its displacement for a distance, unscored parts are marked") {
  const MeshRender whole = rendered(wall(2));
  const MeshRender left = rendered(parallelogram({-4, -4, 2}, {4, 0, 0}, {0, 8, 0}));
  const Image map = distance_map(whole, left, wall(2.04f), small_camera());
  CHECK(static_cast<double>(map.at(5, 15)) == Approx(0.04).epsilon(1e-4));
  CHECK(map.at(30, 15) == kNotScored);
  CHECK(std::isnan(distance_map(left, left, wall(2.04f), small_camera()).at(30, 15)));
  const Image picture = distance_picture(map);
  CHECK(picture.at(5, 15, 0) == Approx(color_of(0.04f).at(0, 0, 0)).margin(kColorMargin));
  CHECK(picture.at(30, 15, 2) > picture.at(30, 15, 0));  // bluish, as no error is
}

TEST_CASE("meshes stand beside the truth in one range of colours, a run without one is missing") {
  const TempFolder folder;
  write_mesh_ply(folder / "data/gt/mesh.ply", wall(2));
  write_mesh_ply(folder / "a/mesh.ply", wall(2.03f));
  write_mesh_ply(folder / "b/mesh.ply", wall(1.95f));
  write_file(folder / "d/mesh.ply", "not a mesh");
  const PictureGrid grid = meshes_figure({scene_of(folder.path(), {"a", "b", "c", "d"})});
  CHECK(grid.titles == std::vector<std::string>{"truth", "a", "b", "c", "d"});
  REQUIRE(grid.row_titles == std::vector<std::string>{"room_1\nmesh", "room_1\nerror"});
  for (const auto& row : grid.rows) {
    CHECK(row[3].empty());
    CHECK(row[4].empty());
  }
  CHECK(grid.rows[0][1].size() == grid.rows[0][0].size());
  check_color(grid.rows[1][0], color_of(0));
  check_color(grid.rows[1][1], color_of(0.03f));
  check_color(grid.rows[1][2], color_of(0.05f));
}

TEST_CASE("what lies behind glass has rows of its own, one mesh serves for both") {
  const TempFolder folder;
  write_mesh_ply(folder / "data/gt/mesh.ply", wall(2));
  write_mesh_ply(folder / "data/gt/mesh_behind.ply", wall(3));
  write_mesh_ply(folder / "a/mesh.ply", wall(2.02f));
  write_mesh_ply(folder / "a/mesh_transmission.ply", wall(3.04f));
  write_mesh_ply(folder / "b/mesh.ply", wall(2.96f));
  const PictureGrid grid = meshes_figure({scene_of(folder.path(), {"a", "b"})});
  REQUIRE(grid.rows.size() == 4);
  check_color(grid.rows[1][1], color_of(0.02f));
  check_color(grid.rows[1][2], color_of(1));
  check_color(grid.rows[3][1], color_of(0.04f));
  check_color(grid.rows[3][2], color_of(0.04f));
}

TEST_CASE("without a true mesh there is no error, without any mesh of a run no figure") {
  const TempFolder folder;
  write_mesh_ply(folder / "a/mesh.ply", wall(2));
  const PictureGrid grid = meshes_figure({scene_of(folder.path(), {"a"})});
  REQUIRE(grid.rows.size() == 1);
  CHECK(grid.rows[0][0].empty());
  CHECK_FALSE(grid.rows[0][1].empty());
  write_mesh_ply(folder / "data/gt/mesh.ply", wall(2));
  CHECK(meshes_figure({scene_of(folder.path(), {"c"})}).rows.empty());
  CHECK(meshes_figure({}).rows.empty());
}

TEST_CASE("the protocol that a run was scored with says what is culled") {
  const TempFolder folder;
  TriangleMesh mesh = wall(2);
  write_mesh_ply(folder / "data/gt/mesh.ply", mesh);
  write_mesh_ply(folder / "a/mesh.ply", mesh);
  FigureScene scene = scene_of(folder.path(), {"a"});
  scene.train_cameras.front().translation_cam_from_world = {2, 0, 0};  // sees the left half only
  const auto right_edge = [&] {
    const Panel errors = meshes_figure({scene}).rows[1][1];
    return value_at(errors, errors.size().width - 2, 15, 2);
  };
  CHECK(right_edge() > 0.8f);  // stripes
  write_file(folder / "a/metrics.json", R"({"meshes": {"protocol": {"cull": "none"}}})");
  CHECK(right_edge() == Approx(color_of(0).at(0, 0, 2)).margin(kColorMargin));
  // One that was cut off says nothing, and takes no figure with it.
  write_file(folder / "a/metrics.json", R"({"meshes": {"proto)");
  CHECK(right_edge() > 0.8f);
}
