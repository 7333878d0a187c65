// SPDX-License-Identifier: MIT
// Renders against a dataset: its test views, of the folder and of the packed scene alike.
#include "metrics/tools/dataset_views.h"

#include <catch2/catch.hpp>

#include <sstream>

#include "datasets/packed_scene.h"
#include "glint/scene/image_files.h"
#include "metrics/psnr.h"
#include "metrics/tools/tool.h"
#include "tests/support/small_room.h"

using namespace glint;

namespace {

struct Result {
  int code = 0;
  std::string out, err;
  Json json() const { return Json::parse(out); }
};

Result run(std::unique_ptr<MetricTool> tool, std::vector<std::string> args) {
  args.emplace_back("--quiet");
  std::ostringstream out, err;
  const int code = run_tool(*tool, args, out, err);
  return {code, out.str(), err.str()};
}

// A run folder of grey renders and metre-deep maps, and the packed room.
struct Case {
  test::TempFolder folder;
  std::string run = folder / "run", packed = folder / "room.safetensors",
              room = test::small_room_folder().string();
  Case() {
    for (const View& view : test::small_room().test) {
      const ImageSize size = view.rgb.size();
      const fs::path renders = folder / "run/renders" / flat_view_name(view.name);
      write_exr(renders / "rgb.exr", Image(size.width, size.height, 3, 0.5f));
      write_exr(renders / "depth.exr", Image(size.width, size.height, 1, 1.0f));
    }
    write_packed_scene(packed, test::small_room());
  }
};

}  // namespace

TEST_CASE("Renders are compared with the test views of a folder and of a packed scene alike") {
  const Case c;
  double mean = 0;
  for (const View& view : test::small_room().test)
    mean += psnr(Image(view.rgb.width(), view.rgb.height(), 3, 0.5f), view.rgb);
  mean /= static_cast<double>(test::small_room().test.size());
  for (const std::string& dataset : {c.room, c.packed}) {
    INFO(dataset);
    const Result result = run(make_psnr_tool(), {c.run, dataset, "--json"});
    REQUIRE(result.code == 0);
    CHECK(result.json()["num_images"] == test::small_room().test.size());
    CHECK(result.json()["mean"]["psnr"] == Approx(mean).epsilon(1e-9));
    const Result glass = run(make_psnr_tool(), {c.run, dataset, "--glass", dataset, "--json"});
    REQUIRE(glass.code == 0);
    CHECK(glass.json()["mean"].contains("psnr@glass"));
    CHECK(run(make_ssim_tool(), {c.run, dataset}).code == 0);
    CHECK(run(make_depth_tool(), {c.run, dataset}).code == 0);
  }
}

TEST_CASE("All views of a dataset are asked for by --views, and missing renders are named") {
  const Case c;
  for (const std::string& dataset : {c.room, c.packed}) {
    INFO(dataset);
    const Result all = run(make_psnr_tool(), {c.run, dataset, "--views", "all"});
    CHECK(all.code == 2);
    CHECK_THAT(all.err, Catch::Contains("(no prediction)"));
    CHECK(run(make_psnr_tool(), {c.run, dataset, "--views", "all", "--allow-missing"}).code == 0);
  }
  fs::remove_all(c.folder / "run/renders" / test::small_room().test[0].name);
  CHECK(run(make_psnr_tool(), {c.run, c.room}).code == 2);
}

TEST_CASE("A run of smaller pictures is compared with the views at its size") {
  const test::TempFolder folder;
  LoadOptions options;
  options.max_pixels = 1000;
  const Scene small = load_scene(test::small_room_folder(), options);
  for (const View& view : small.test)
    write_exr(folder / "renders" / view.name / "rgb.exr", view.rgb);
  write_file(folder / "config.json", R"({"max_pixels": 1000})");
  const Result result =
      run(make_psnr_tool(), {folder.path().string(), test::small_room_folder().string(), "--json"});
  REQUIRE(result.code == 0);
  CHECK(result.json()["mean"]["psnr"] == 100);
}

TEST_CASE("One picture is not compared with a dataset") {
  const Case c;
  const std::string file = c.run + "/renders/" + test::small_room().test[0].name + "/rgb.exr";
  CHECK(run(make_psnr_tool(), {file, c.packed}).code == 1);
  CHECK(run(make_psnr_tool(), {file, c.room}).code == 1);
}
