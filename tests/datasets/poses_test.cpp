// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <cmath>

#include "datasets/dataset.h"
#include "glint/scene/image_files.h"
#include "glint/scene/ply.h"
#include "tests/support/box_room.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

std::string matrix_of(const Camera& camera) {
  const Mat3d r = transpose(camera.rotation_cam_from_world);
  const Vec3d c = -(r * camera.translation_cam_from_world);
  std::string text;
  for (int i = 0; i < 3; ++i)
    text += fmt::format(
        "{:.17g} {:.17g} {:.17g} {:.17g}\n", r.rows[i].x, r.rows[i].y, r.rows[i].z, c[i]
    );
  return text + "0 0 0 1\n";
}

// A folder with a room of 10 views.
struct PosesFolder : TempFolder {
  std::vector<View> views = box_room_views(10, {48, 36});
  PosesFolder() {
    const Camera& lens = views[0].camera;
    write_file(
        path() / "intrinsics.txt",
        fmt::format("{} 0 {}\n0 {} {}\n0 0 1\n", lens.fx, lens.cx, lens.fy, lens.cy)
    );
    for (const View& view : views) {
      write_png(path() / "images" / (view.name + ".png"), view.rgb);
      write_file(path() / "poses" / (view.name + ".txt"), matrix_of(view.camera));
    }
  }
};

}  // namespace

TEST_CASE("pictures with a matrix each are a scene") {
  const PosesFolder folder;
  const Scene scene = load_scene(folder.path(), {});
  CHECK(scene.dataset == "poses");
  REQUIRE(scene.test.size() == 2);
  REQUIRE(scene.train.size() == 8);
  const Camera &found = scene.train[2].camera, &made = folder.views[3].camera;
  CHECK(length(found.translation_cam_from_world - made.translation_cam_from_world) < 1e-12);
  for (int i = 0; i < 3; ++i)
    CHECK(
        length(found.rotation_cam_from_world.rows[i] - made.rotation_cam_from_world.rows[i]) < 1e-12
    );
  CHECK(found.fx == Approx(made.fx));
  CHECK(found.cy == Approx(made.cy));
}

TEST_CASE("views may have intrinsics of their own, points are read, lost frames are left out") {
  const PosesFolder folder;
  write_file(folder / "intrinsics/0003.txt", "99 0 24 0  0 98 18 0  0 0 1 0  0 0 0 1");
  std::string lost;
  for (int i = 0; i < 16; ++i) lost += "-inf ";
  write_file(folder / "poses/0005.txt", lost);
  PointCloud points;
  for (int i = 0; i < 5; ++i) points.positions.push_back({static_cast<float>(i), 0, 1});
  points.colors.assign(5, {1, 0, 0});
  write_point_ply(folder / "points.ply", points);
  const Scene scene = load_scene(folder.path(), {});
  CHECK(scene.train.size() + scene.test.size() == 9);
  REQUIRE(scene.data_notes.size() == 1);
  CHECK_THAT(scene.data_notes[0], Contains("0005.txt: not finite"));
  CHECK(scene.train[2].camera.fx == 99);
  CHECK(scene.train[2].camera.fy == 98);
  CHECK(scene.points.positions.size() == 5);
}

TEST_CASE("matrices that are none are named with what was found") {
  const PosesFolder folder;
  const auto message = [&] { return bad_reference([&] { load_scene(folder.path(), {}); }); };
  write_file(folder / "poses/0003.txt", "1 0 0 0 1 0");
  CHECK_THAT(
      message(), Contains("0003.txt") && Contains("6 numbers, expected 9 (3x3) or 16 (4x4)")
  );
  write_file(folder / "poses/0003.txt", "1 0 0 x");
  CHECK_THAT(message(), Contains("'x' is no number"));
  write_file(folder / "poses/0003.txt", std::string(100000, '1'));
  CHECK_THAT(message(), Contains("0003.txt"));
  fs::remove(folder / "poses/0003.txt");
  CHECK_THAT(message(), Contains("0003.txt"));
  const auto findings = check_dataset(folder.path());
  REQUIRE_FALSE(findings.empty());
  CHECK(findings[0].check == "camera-field");
}
