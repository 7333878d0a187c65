// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "datasets/dataset.h"
#include "glint/core/config.h"
#include "glint/scene/image_files.h"
#include "tests/support/box_room.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;

namespace {

// As Blender's scripts leave it: train/r_0.png ..., test/r_0.png ..., paths without extension.
struct BlenderFolder : TempFolder {
  std::vector<View> views = box_room_views(10, {48, 36});
  BlenderFolder() {
    const TempFolder other;
    write_nerfstudio(other.path(), views);
    const Json all = Json::parse(read_file(other / "transforms.json"));
    for (const std::string split : {"train", "test"}) {
      Json json = {{"camera_angle_x", 75 * 3.14159265358979323846 / 180}};
      for (std::size_t i = split == "train" ? 0 : 7; i < (split == "train" ? 7u : 10u); ++i) {
        const std::string file = fmt::format("{}/r_{}", split, json["frames"].size());
        write_png(path() / (file + ".png"), views[i].rgb);
        json["frames"].push_back(
            {{"file_path", "./" + file},
             {"transform_matrix", all["frames"][i]["transform_matrix"]},
             {"rotation", 0.01}}
        );
      }
      write_file(path() / ("transforms_" + split + ".json"), json.dump());
    }
  }
};

}  // namespace

TEST_CASE("Blender's folders are loaded with the split of their files") {
  const BlenderFolder folder;
  CHECK(find_loader(folder.path()).name == "blender");
  Scene scene = load_scene(folder.path(), {});
  CHECK(scene.dataset == "blender");
  REQUIRE(scene.train.size() == 7);
  REQUIRE(scene.test.size() == 3);
  CHECK(scene.train[0].name == "r_3");
  CHECK(scene.train[4].name == "train_r_0");  // r_0 is in both folders
  CHECK(scene.test[1].name == "test_r_1");
  CHECK(scene.train[0].camera.fx == Approx(folder.views[0].camera.fx));
  CHECK(
      length(scene.test[1].camera.center() - folder.views[8].camera.center()) ==
      Approx(0).margin(1e-12)
  );
  CHECK(scene.points.positions.empty());
  CHECK(check_dataset(folder.path()).empty());
  fs::remove(folder / "transforms_test.json");
  scene = load_scene(folder.path(), {});
  CHECK(scene.test.size() == 1);  // every 8th of seven
}
