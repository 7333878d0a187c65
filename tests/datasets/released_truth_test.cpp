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
  std::vector<View> views = box_room_views(10, kSize);
  fs::path scene = path() / "scene_1";
  ReleasedScene() {
    write_easyvolcap(scene, views);
    fs::remove_all(scene / "gt");
  }
  // What the release's evaluation reads, of the test views.
  void write_truth(const fs::path& folder) const {
    for (const std::size_t view : {0u, 8u}) {
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
  for (const char* place :
       {"geometry_gt/scene_1", "scene_1/geometry_gt", "scene_1/geometry_gt/scene_1"}) {
    INFO(place);
    data.write_truth(data / place);
    const Scene scene = load_scene(data.scene, {});
    REQUIRE(scene.test.size() == 2);
    for (const char* map : {"depth", "normal"}) {
      const MapRow& row = *find_map(map);
      CHECK(largest_difference(scene.test[1].truth[row], data.views[8].truth[row]) == 0);
    }
    CHECK(scene.train[0].truth.empty());
    CHECK(fs::equivalent(true_mesh(data.scene), data / place / "gt_mesh.ply"));
    CHECK(true_mesh(data.scene, "gt/mesh_behind.ply") == data.scene / "gt/mesh_behind.ply");
    CHECK(fs::equivalent(true_mesh(data.scene / "."), true_mesh(data.scene)));
    CHECK(check_dataset(data.scene).empty());
    fs::remove_all(data / place);
  }
}

TEST_CASE("A scene's own truth counts before the release's") {
  const ReleasedScene data;
  data.write_truth(data / "geometry_gt/scene_1");
  const Image depth(kSize.width, kSize.height, 1);
  write_exr(data.scene / "gt/depth/0008.exr", depth);
  write_mesh_ply(data.scene / kTrueMesh, {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
  CHECK(true_mesh(data.scene) == data.scene / kTrueMesh);
  MapFiles files;
  files["depth"] = data.scene / "gt/depth/0008.exr";
  add_released_maps(released_truth(data.scene), "0008", files);
  CHECK(files["depth"] == data.scene / "gt/depth/0008.exr");
  CHECK(fs::equivalent(
      files["normal"], data / "geometry_gt/scene_1/normals_gt/val_normalCam_0008.npy"
  ));
}

TEST_CASE("Released maps go by the number that a camera's name ends in") {
  const ReleasedScene data;
  const fs::path truth = data / "geometry_gt/scene_1";
  data.write_truth(truth);
  const auto depth_of_view = [&](const std::string& view) {
    MapFiles files;
    add_released_maps(truth, view, files);
    return files["depth"].filename().string();
  };
  CHECK(depth_of_view("0008") == "val_depthZ_0008.npy");
  CHECK(depth_of_view("cam_8") == "val_depthZ_0008.npy");
  CHECK(depth_of_view("000000") == "val_depthZ_0000.npy");
  CHECK(depth_of_view("0007").empty());
  CHECK(depth_of_view("front").empty());
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
