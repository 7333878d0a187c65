// SPDX-License-Identifier: MIT
#include "reports/run/import/prediction_files.h"

#include <catch2/catch.hpp>

#include <sstream>

#include "glint/core/error.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

const std::vector<std::string> kViews = {"0000", "0008"};

// `files`: names with spaces between.
PredictionFiles find_in(const std::string& files) {
  const test::TempFolder folder;
  std::istringstream names(files);
  for (std::string file; names >> file;) write_file(folder.path() / file, "x");
  PredictionFiles found = find_predictions(folder.path(), kViews);
  for (auto& view : found.views)
    for (auto& [map, path] : view) path = fs::relative(path, folder.path());
  if (!found.mesh.empty()) found.mesh = fs::relative(found.mesh, folder.path());
  return found;
}

struct Layout {
  std::string files, map, second;  // file of the second view
  Matching matching;
};
const Layout kLayouts[] = {
    {"renders/0000/rgb.exr renders/0000/rgb.png renders/0008/rgb.exr renders/0008/rgb.png",
     "rgb",
     "renders/0008/rgb.exr",
     Matching::kName},
    {"test/ours_7000/renders/00000.png test/ours_30000/renders/00000.png "
     "test/ours_30000/renders/00001.png",
     "rgb",
     "test/ours_30000/renders/00001.png",
     Matching::kOrder},
    {"RENDER/frame0000_camera0000.png RENDER/frame0000_camera0000_error.png "
     "RENDER/frame0000_camera0000_gt.png RENDER/frame0000_camera0008.png "
     "RENDER/frame0000_camera0008_error.png RENDER/frame0000_camera0008_gt.png",
     "rgb",
     "RENDER/frame0000_camera0008.png",
     Matching::kOrder},
    {"RENDER/frame0000_camera0000.png RENDER/frame0000_camera0008.png "
     "geo_metric/normals_pred/0000.npy geo_metric/normals_pred/0001.npy",
     "normal",
     "geo_metric/normals_pred/0001.npy",
     Matching::kOrder},
    {"color/0000.png color/0008.png gt-color/0000.png", "rgb", "color/0008.png", Matching::kName},
    {"renders/val_0000.png renders/val_0000_normal_29999.png renders/val_0001.png "
     "renders/val_0001_normals_from_depth_29999.png",
     "rgb",
     "renders/val_0001.png",
     Matching::kOrder},
    {"renders/val_step29999_0000.png renders/val_step29999_0001.png",
     "rgb",
     "renders/val_step29999_0001.png",
     Matching::kOrder},
    {"rgb/0000.png rgb/0008.png gt-rgb/0000.png gt-rgb/0008.png",
     "rgb",
     "rgb/0008.png",
     Matching::kName},
    {"0000.png 0008.png 0000_depth.npy 0008_depth.npy",
     "depth",
     "0008_depth.npy",
     Matching::kOrder},
    {"test/ours_30000/renders/00000.png test/ours_30000/renders/00001.png "
     "test/ours_30000/vis/depth_00000.tiff test/ours_30000/vis/depth_00001.tiff",
     "depth",
     "test/ours_30000/vis/depth_00001.tiff",
     Matching::kOrder},
    {"pred/0000_0000_000000.png pred/0008_0008_000000.png comparison/0000_0000_000000.png "
     "comparison/0008_0008_000000.png",
     "rgb",
     "pred/0008_0008_000000.png",
     Matching::kOrder},
    {"pred/0000_0000_000000.png pred/0008_0008_000000.png geometry/depths_pred/0000.npy "
     "geometry/depths_pred/0008.npy geometry/depths_pred/0012.npy",
     "depth",
     "geometry/depths_pred/0008.npy",
     Matching::kName},
    {"test/rgb/0000.jpg test/rgb/0008.jpg", "rgb", "test/rgb/0008.jpg", Matching::kName},
    {"rgb/0000.png rgb/0008.png normal/0000.npy normal/0008.npy normal/0009.npy",
     "normal",
     "normal/0008.npy",
     Matching::kName}};

}  // namespace

TEST_CASE("Renders are found in the layouts of the programs that people use") {
  for (const Layout& layout : kLayouts) {
    INFO(layout.files);
    const PredictionFiles found = find_in(layout.files);
    CHECK(found.views.at(1).at(layout.map) == fs::path(layout.second));
    CHECK(found.matching.at(layout.map) == layout.matching);
  }
}

TEST_CASE("Files in natural order go to views in theirs") {
  const PredictionFiles found = find_in("rgb/frame10.png rgb/frame9.png");
  CHECK(found.views[0].at("rgb") == fs::path("rgb/frame9.png"));
  CHECK(found.views[1].at("rgb") == fs::path("rgb/frame10.png"));
}

TEST_CASE("The mesh of other programs is found") {
  CHECK(find_in("rgb/0000.png rgb/0008.png").mesh.empty());
  CHECK(
      find_in("rgb/0000.png rgb/0008.png train/ours_30000/fuse_post.ply").mesh ==
      fs::path("train/ours_30000/fuse_post.ply")
  );
}

TEST_CASE("A map of one kind is not taken for another") {
  const PredictionFiles found = find_in(
      "renders/0000/rgb.exr renders/0008/rgb.exr renders/0000/depth.exr renders/0008/depth.exr"
  );
  CHECK(found.matching.size() == 2);
}

TEST_CASE("The release's files of true depth are no prediction") {
  const PredictionFiles found =
      find_in("0000.png 0008.png val_depthZ_0000.npy val_depthZ_0008.npy");
  CHECK_FALSE(found.matching.contains("depth"));
}

TEST_CASE("Files that look like a map and are not read are named") {
  const test::TempFolder folder;
  for (const char* file :
       {"rgb/0000.png", "rgb/0008.png", "renders_depth/0000.png", "renders_depth/0008.png"})
    write_file(folder.path() / file, "x");
  const PredictionFiles found = find_predictions(folder.path(), kViews);
  CHECK_FALSE(found.matching.contains("depth"));
  const auto unread = unread_files(folder.path(), "depth", found);
  REQUIRE(unread.size() == 2);
  CHECK(unread[0] == folder / "renders_depth/0000.png");
  CHECK(unread_files(folder.path(), "normal", found).empty());
}

TEST_CASE("Folders that do not fit the test views are refused with what is there") {
  CHECK_THROWS_WITH(find_in("notes.txt"), Catch::Contains("no renders; looked for"));
  CHECK_THROWS_WITH(
      find_in("rgb/a.png rgb/b.png rgb/c.png"),
      Catch::Contains("3 files for rgb") && Catch::Contains("2 test views (0000")
  );
  CHECK_THROWS_WITH(find_predictions("/nowhere", kViews), Catch::Contains("no such folder"));
}
