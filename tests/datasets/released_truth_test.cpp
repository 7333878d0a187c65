// SPDX-License-Identifier: MIT
#include "datasets/released_truth.h"

#include <catch2/catch.hpp>

#include "datasets/dataset.h"
#include "glint/scene/image_files.h"
#include "glint/scene/ply.h"
#include "tests/support/box_room.h"
#include "tests/support/image_difference.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr ImageSize kSize{48, 36};

// scene_1/ as it is released, without any truth; test views are 0000 and 0008.
struct ReleasedScene : TempFolder {
  std::vector<View> views;
  fs::path scene = path() / "scene_1";
  explicit ReleasedScene(int count = 10) : views(box_room_views(count, kSize)) {
    write_easyvolcap(scene, views);
    fs::remove_all(scene / "gt");
  }
  // What the release's evaluation reads, of the test views.
  void write_truth(const fs::path& folder) const {
    for (std::size_t view = 0; view < views.size(); view += 8) {
      write_npy(
          folder / fmt::format("depths_gt/val_depthZ_{:04}.npy", view), views[view].truth["depth"]
      );
      write_npy(
          folder / fmt::format("normals_gt/val_normalCam_{:04}.npy", view),
          views[view].truth["normal"]
      );
    }
    write_mesh_ply(folder / "gt_mesh.ply", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
  }
};

}  // namespace

TEST_CASE("The release's true geometry is read from beside the scenes") {
  const ReleasedScene data;
  CHECK(released_truth(data.scene).empty());
  CHECK(load_scene(data.scene, {}).test[1].truth.empty());
  CHECK(true_mesh(data.scene) == data.scene / kTrueMesh);
  const fs::path truth = data / "geometry_gt/scene_1";
  data.write_truth(truth);
  const Scene scene = load_scene(data.scene, {});
  REQUIRE(scene.test.size() == 2);
  for (const char* map : {"depth", "normal"}) {
    const MapRow& row = *find_map(map);
    CHECK(largest_difference(scene.test[1].truth[row], data.views[8].truth[row]) == 0);
  }
  CHECK(scene.train[0].truth.empty());
  CHECK(fs::equivalent(true_mesh(data.scene), truth / "gt_mesh.ply"));
  CHECK(true_mesh(data.scene, "gt/mesh_behind.ply") == data.scene / "gt/mesh_behind.ply");
  CHECK(check_dataset(data.scene).empty());
  fs::create_directory_symlink(data.scene, data / "linked");
  for (const char* name : {"scene_1/", "scene_1/.", "geometry_gt/../scene_1", "linked"}) {
    INFO(name);
    CHECK(fs::equivalent(released_truth(data / name), truth));
  }
}

TEST_CASE("True depth of test views alone is checked, and does not hide what points say of priors"
) {
  const ReleasedScene data(60);
  data.write_truth(data / "geometry_gt/scene_1");
  CHECK(check_dataset(data.scene).empty());
  for (std::size_t view = 0; view < data.views.size(); view += 8) {
    Image depth = data.views[view].truth["depth"];
    for (float& z : depth.values()) z *= 1000;
    write_npy(
        data / fmt::format("geometry_gt/scene_1/depths_gt/val_depthZ_{:04}.npy", view), depth
    );
  }
  const auto findings = check_dataset(data.scene);
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].check == "depth-poses");
  const Scene scene = load_scene(data.scene, {});
  CHECK_THAT(scene.data_notes.at(0), Catch::Contains("detected"));
}

TEST_CASE("A scene's own truth counts before the release's") {
  const ReleasedScene data;
  data.write_truth(data / "geometry_gt/scene_1");
  write_mesh_ply(data.scene / kTrueMesh, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
  CHECK(true_mesh(data.scene) == data.scene / kTrueMesh);
  SceneIndex index;
  index.views.resize(1);
  index.views[0].name = "0008";
  index.views[0].truth["depth"] = "own.exr";
  add_released_truth(data.scene, index);
  CHECK(index.views[0].truth["depth"] == "own.exr");
  CHECK(index.views[0].truth["normal"].filename() == "val_normalCam_0008.npy");
}

TEST_CASE("Released maps go by the number that a view's name ends in") {
  const ReleasedScene data;
  const fs::path truth = data / "geometry_gt/scene_1";
  data.write_truth(truth);
  const auto file_of = [&](const std::string& view) {
    return released_depth(truth, view).filename().string();
  };
  CHECK(file_of("0008") == "val_depthZ_0008.npy");
  CHECK(file_of("cam_8") == "val_depthZ_0008.npy");
  CHECK(file_of("000000") == "val_depthZ_0000.npy");
  CHECK(file_of("0007").empty());
  CHECK(file_of("front").empty());
  SceneIndex index;
  index.views.resize(3);
  index.views[0].name = "left_0008", index.views[1].name = "right_0008", index.views[2].name = "0";
  add_released_truth(data.scene, index);
  CHECK(index.views[0].truth.empty());
  CHECK(index.views[1].truth.empty());
  CHECK(index.views[2].truth.has("depth"));
  REQUIRE(index.remarks.size() == 1);
  CHECK_THAT(index.remarks[0].message, Catch::Contains("2 views have names that end in 0008"));
}

TEST_CASE("Released depth of another size than the picture is refused by name") {
  const ReleasedScene data;
  data.write_truth(data / "geometry_gt/scene_1");
  write_npy(data / "geometry_gt/scene_1/depths_gt/val_depthZ_0008.npy", Image(24, 18, 1));
  CHECK_THAT(
      bad_reference([&] { load_scene(data.scene, {}); }),
      Catch::Contains("val_depthZ_0008.npy: 24 x 18 pixels, its view's image has 48 x 36")
  );
}
