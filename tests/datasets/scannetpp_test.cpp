// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "datasets/colmap_model.h"
#include "datasets/dataset.h"
#include "glint/core/config.h"
#include "glint/scene/camera.h"
#include "glint/scene/image_files.h"
#include "tests/support/box_room.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

// A folder of 10 views as the toolkit leaves it: views 2 and 7 are test frames, which it also lists
// among the frames; the world of the JSON is turned against COLMAP's.
struct ScanFolder : TempFolder {
  std::vector<View> views = box_room_views(10, {48, 36});
  Json json;

  ScanFolder() {
    std::vector<View> turned = views;
    for (View& view : turned) {  // world axes (x, y, z) become (y, x, -z)
      Mat3d& r = view.camera.rotation_cam_from_world;
      for (Vec3d& row : r.rows) row = {row.y, row.x, -row.z};
    }
    write_nerfstudio(path() / "made", turned);
    json = Json::parse(read_file(path() / "made/transforms.json"));
    fs::create_directories(path() / "dslr");
    fs::rename(path() / "made/images", path() / "dslr/undistorted_images");
    fs::remove_all(path() / "made");
    json["camera_model"] = "PINHOLE";
    for (Json& frame : json["frames"])
      frame["file_path"] = fs::path(frame["file_path"].get<std::string>()).filename().string();
    for (const int i : {2, 7}) json["test_frames"].push_back(json["frames"][i]);
    store();
    write_model();
  }
  void store() const {
    write_file(path() / "dslr/nerfstudio/transforms_undistorted.json", json.dump());
  }
  void write_model() const {
    ColmapModel model;
    model.cameras[1] = {5, 60, 40, {30, 30, 30, 20, 0.1, 0, 0, 0}};  // the fisheye
    PointCloud points;
    for (std::uint32_t i = 0; i < views.size(); ++i) {
      const Camera& camera = views[i].camera;
      ColmapImage image{.id = i + 1, .camera_id = 1, .name = views[i].name + ".png"};
      image.rotation_cam_from_world = quaternion_from_rotation(camera.rotation_cam_from_world);
      image.translation_cam_from_world = camera.translation_cam_from_world;
      model.images.push_back(image);
      points.positions.push_back(cast<float>(camera.to_world(camera.ray_in_cam(24, 18))));
    }
    points.colors.assign(points.positions.size(), {1, 0, 0});
    write_colmap_model(path() / "dslr/colmap", model, points);
  }
};

}  // namespace

TEST_CASE("a scene of ScanNet++ has COLMAP's poses and points, the JSON's intrinsics and split") {
  const ScanFolder folder;
  const Scene scene = load_scene(folder.path(), {});
  CHECK(scene.dataset == "scannetpp");
  REQUIRE(scene.test.size() == 2);
  REQUIRE(scene.train.size() == 8);
  CHECK(scene.test[1].name == folder.views[7].name);
  CHECK(scene.points.positions.size() == 10);
  const Camera &found = scene.train[2].camera, &made = folder.views[3].camera;
  CHECK(found.fx == Approx(made.fx));
  CHECK(length(found.translation_cam_from_world - made.translation_cam_from_world) < 1e-9);
  for (int i = 0; i < 3; ++i)
    CHECK(
        length(found.rotation_cam_from_world.rows[i] - made.rotation_cam_from_world.rows[i]) < 1e-9
    );
  CHECK(check_dataset(folder.path()).empty());
}

TEST_CASE("without COLMAP's model the JSON's poses count and there are no points") {
  const ScanFolder folder;
  fs::remove_all(folder / "dslr/colmap");
  const Scene scene = load_scene(folder.path(), {});
  CHECK(scene.points.positions.empty());
  const Mat3d &found = scene.train[2].camera.rotation_cam_from_world,
              &made = folder.views[3].camera.rotation_cam_from_world;
  CHECK(found.rows[0].x == Approx(made.rows[0].y).margin(1e-9));
}

TEST_CASE("hidden test pictures are left out and said; then every 8th view is held out") {
  const ScanFolder folder;
  for (const int i : {2, 7})
    fs::remove(folder / "dslr/undistorted_images" / (folder.views[i].name + ".png"));
  const Scene scene = load_scene(folder.path(), {});
  CHECK(scene.train.size() == 7);
  CHECK(scene.test.size() == 1);
  REQUIRE(scene.data_notes.size() == 1);
  CHECK_THAT(scene.data_notes[0], Contains("2 test views have no picture"));
}

TEST_CASE("what the toolkit has not undistorted, and views without a pose, are errors that say so"
) {
  ScanFolder folder;
  const auto message = [&] { return bad_reference([&] { load_scene(folder.path(), {}); }); };
  folder.json["frames"][4]["file_path"] = "strange.png";
  folder.store();
  CHECK_THAT(message(), Contains("strange.png") && Contains("no pose of it"));
  fs::rename(folder / "dslr/undistorted_images", folder / "dslr/resized_images");
  CHECK_THAT(message(), Contains("dslr.undistort"));
  fs::rename(
      folder / "dslr/nerfstudio/transforms_undistorted.json",
      folder / "dslr/nerfstudio/transforms.json"
  );
  CHECK_THAT(message(), Contains("dslr.undistort"));
}

TEST_CASE("masks beside the pictures say which pixels count; without their folder that is said") {
  ScanFolder folder;
  for (const char* list : {"frames", "test_frames"})
    for (Json& frame : folder.json[list]) frame["mask_path"] = frame["file_path"];
  folder.store();
  const Scene without = load_scene(folder.path(), {});
  CHECK(without.train[0].counted.empty());
  REQUIRE(without.data_notes.size() == 1);
  CHECK_THAT(without.data_notes[0], Contains("all pixels count"));
  Image mask(48, 36, 1, 1.0f);
  mask.at(3, 4) = 0;
  for (const View& view : folder.views)
    write_png(folder / ("dslr/undistorted_anon_masks/" + view.name + ".png"), mask);
  const Scene scene = load_scene(folder.path(), {});
  CHECK(scene.train[0].counted.at(3, 4) == 0);
  CHECK(scene.test[1].counted.at(3, 4) == 0);
  REQUIRE(scene.data_notes.size() == 1);
  CHECK_THAT(scene.data_notes[0], Contains("8 of 8 train views") && Contains("2 of 2 test views"));
}
