// SPDX-License-Identifier: MIT
// What the programs say of files that other programs left behind.
#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <sstream>

#include "glint/core/error.h"
#include "glint/core/vec.h"
#include "glint/scene/image_files.h"
#include "metrics/psnr.h"
#include "metrics/tools/tool.h"
#include "tests/metrics/golden_images.h"
#include "tests/support/exif.h"
#include "tests/support/temp_folder.h"
#include "tests/support/write_jpeg.h"

using namespace glint;
using Catch::Contains;

namespace {

struct Result {
  int code = 0;
  std::string out, err;
  Json json() const { return Json::parse(out); }
};

Result run(std::unique_ptr<MetricTool> tool, std::vector<std::string> args) {
  std::ostringstream out, err;
  args.push_back("--quiet");
  const int code = run_tool(*tool, args, out, err);
  return {code, out.str(), err.str()};
}

std::string warnings_of(const Result& result) {
  std::string all;
  const Json json = result.json();
  for (const Json& image : json["images"])
    for (const Json& warning : image.value("warnings", Json::array()))
      all += warning.get<std::string>() + "\n";
  return all;
}

}  // namespace

TEST_CASE("A file that EXIF turns is scored as stored, with a warning") {
  const test::TempFolder folder;
  const Image rendered = golden::rendered_image(24, 16, 3);
  const Image truth = golden::reference_image(24, 16, 3);
  write_png(folder / "a.png", rendered);
  write_png(folder / "b.png", truth);
  write_file(folder / "b.png", test::png_with_exif(read_file(folder / "b.png"), 3, true));
  const Result turned = run(make_psnr_tool(), {folder / "a.png", folder / "b.png", "--json"});
  CHECK(turned.json()["mean"]["psnr-8bit"] == psnr_8bit(rendered, read_image(folder / "b.png", 3)));
  CHECK_THAT(warnings_of(turned), Contains("b.png: states EXIF orientation 3"));
  write_png(folder / "a.png", Image(16, 24, 3, 0.5f));
  const Result wrong_size = run(make_psnr_tool(), {folder / "a.png", folder / "b.png", "--json"});
  CHECK(wrong_size.code != 0);
  CHECK_THAT(wrong_size.err, Contains("16 x 24") && Contains("EXIF orientation 3"));
}

namespace {

Image of_pixels(int channels, const std::function<Vec3d(double, double)>& value) {
  return golden::make_image(24, 16, channels, [&](int x, int y, int c) {
    return static_cast<float>(value(x / 24.0, y / 16.0)[c]);
  });
}

// Normals that face the camera, of a surface bent both ways.
Vec3d bent(double x, double y) { return normalize(Vec3d{x - 0.3, 0.7 - 1.2 * y, -1}); }

Image depths(double scale) {
  return of_pixels(1, [=](double x, double y) { return Vec3d{scale * (2 + x + 3 * y), 0, 0}; });
}

}  // namespace

TEST_CASE("Normals in other axes are scored as they are, with a word of which would fit") {
  const test::TempFolder folder;
  const auto score = [&](const std::function<Vec3d(Vec3d)>& stored, const char* axes = "opencv") {
    write_exr(
        folder / "a.exr", of_pixels(3, [&](double x, double y) { return stored(bent(x, y)); }), true
    );
    return run(make_normal_tool(), {folder / "a.exr", folder / "b.exr", "--axes", axes, "--json"});
  };
  write_exr(folder / "b.exr", of_pixels(3, bent), true);
  const auto opengl = [](Vec3d n) { return Vec3d{n.x, -n.y, -n.z}; };
  const Result flipped = score(opengl);
  CHECK_THAT(warnings_of(flipped), Contains("far better as 'opengl': give --axes opengl"));
  double expected = 0;  // the angle from its cosine, where the tool takes the sine, too
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 24; ++x) {
      const Vec3d n = bent(x / 24.0, y / 16.0);
      expected += std::acos(dot(n, opengl(n))) * 180 / 3.141592653589793 / (24 * 16);
    }
  CHECK(flipped.json()["mean"]["normal-mae"].get<double>() == Approx(expected).epsilon(1e-3));
  const Result told = score(opengl, "opengl");
  CHECK(warnings_of(told).empty());
  CHECK(told.json()["mean"]["normal-mae"].get<double>() < 0.1);
  const double c = std::cos(1.1), s = std::sin(1.1);
  const auto world = [=](Vec3d n) { return Vec3d{c * n.x - s * n.z, n.y, s * n.x + c * n.z}; };
  CHECK_THAT(warnings_of(score(world)), Contains("the world's axes"));
  const auto noisy = [](Vec3d n) { return normalize(n + 0.4 * Vec3d{n.y * n.y, -n.x, 0.5}); };
  CHECK(warnings_of(score(noisy)).empty());
}

TEST_CASE("Depth in another unit is scored as metres, with the ratio and the likely unit") {
  const test::TempFolder folder;
  write_exr(folder / "b.exr", depths(1));
  const auto warnings = [&](double scale, std::vector<std::string> options = {}) {
    write_exr(folder / "a.exr", depths(scale));
    options.insert(options.begin(), {folder / "a.exr", folder / "b.exr", "--json"});
    const Result result = run(make_depth_tool(), options);
    if (options.size() == 3)
      CHECK(
          result.json()["mean"]["depth-absrel"].get<double>() ==
          Approx(std::abs(scale - 1)).epsilon(1e-4).margin(1e-6)
      );
    return warnings_of(result);
  };
  CHECK_THAT(warnings(1000), Contains("1e+03 times") && Contains("millimetres"));
  CHECK_THAT(warnings(100), Contains("100 times") && Contains("centimetres"));
  CHECK_THAT(warnings(10), Contains("10 times") && Contains("decimetres"));
  CHECK_THAT(warnings(0.001), Contains("0.001 times") && Contains("kilometres"));
  CHECK(warnings(1.3).empty());
  CHECK(warnings(1000, {"--align", "median"}).empty());
}

TEST_CASE("Depth as integers counts steps: of a stated length, of an export, or near millimetres") {
  const test::TempFolder folder;
  write_exr(folder / "b.exr", depths(1));
  const auto write_steps = [](const fs::path& file, double step) {
    Image shares = depths(1);
    for (float& value : shares.values())
      value = static_cast<float>(std::nearbyint(static_cast<double>(value) / step) / 65535);
    write_png16(file, shares);
  };
  const auto run_on = [&](const std::string& name, std::vector<std::string> options) {
    options.insert(options.begin(), {folder / name, folder / "b.exr", "--json"});
    return run(make_depth_tool(), options);
  };
  const auto check = [&](const Result& result, double step, const std::string& from) {
    INFO(result.err);
    REQUIRE(result.code == 0);
    CHECK(result.json()["mean"]["depth-absrel"].get<double>() < step);  // half a step below 2 m
    const Json steps = result.json()["protocol"]["depth-absrel"]["prediction_steps"];
    CHECK(steps["metres"].get<double>() == step);
    CHECK_THAT(steps["from"].get<std::string>(), Contains(from));
  };
  write_steps(folder / "mm.png", 0.001);
  check(run_on("mm.png", {}), 0.001, "near the reference's in millimetres");
  write_steps(folder / "tum.png", 0.0002);
  const Result unknown = run_on("tum.png", {});
  CHECK(unknown.code == 2);
  CHECK_THAT(
      unknown.err, Contains("tum.png: integers hold no metres") && Contains("--depth-scale")
  );
  check(run_on("tum.png", {"--depth-scale", "0.0002"}), 0.0002, "--depth-scale");
  write_steps(folder / "capture/depths/0.png", 0.0002);
  write_file(folder / "capture/scene.json", R"({"side_maps": true, "depth_scale": 0.0002})");
  check(run_on("capture/depths/0.png", {}), 0.0002, "scene.json");
  const Result both =
      run(make_depth_tool(),
          {folder / "mm.png", folder / "capture/depths/0.png", "--depth-scale", "0.001", "--json"});
  CHECK(both.json()["mean"]["depth-absrel"].get<double>() == Approx(0.8).epsilon(1e-3));
  CHECK(both.json()["protocol"]["depth-absrel"]["reference_steps"]["metres"] == 0.001);
}

TEST_CASE("Predictions as JPEG are scored and told to be lossy, once") {
  const test::TempFolder folder;
  for (const char* name : {"1", "2", "3"}) {
    write_png(folder / fmt::format("truth/{}.png", name), golden::reference_image(24, 16, 3));
    if (*name != '3')
      test::write_jpeg(
          folder / fmt::format("mine/{}.jpg", name), golden::rendered_image(24, 16, 3)
      );
  }
  write_png(folder / "mine/3.png", golden::rendered_image(24, 16, 3));
  const Result result = run(make_psnr_tool(), {folder / "mine", folder / "truth", "--json"});
  REQUIRE(result.code == 0);
  CHECK_THAT(warnings_of(result), Catch::StartsWith("2 of 3 predictions are JPEG, which is lossy"));
}
