// SPDX-License-Identifier: MIT
// Real glass with truth, in files made as their authors describe them: ClearPose, RT-Splatting's
// scenes, GlassRecon (docs/reference/datasets.md).
#include <catch2/catch.hpp>

#include <cmath>
#include <sstream>

#include "datasets/dataset.h"
#include "datasets/mat_file.h"
#include "glint/core/error.h"
#include "glint/scene/image_files.h"
#include "metrics/tools/tool.h"
#include "tests/support/mat_bytes.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

constexpr int kWidth = 12, kHeight = 8;

// Camera at (1, 2, 3 + i), turned by 90 degrees about y: it looks along the world's x.
std::string frame(
    const std::string& name, int i, const std::string& intrinsics = "intrinsic_matrix"
) {
  const double z = 3 + i;
  return mat_struct(
      name,
      {{"cls_indexes", mat_array("", 2, 1, {5, 7})},
       {intrinsics, mat_array("", 3, 3, {10, 0, 0, 0, 11, 0, 5.5, 4.25, 1})},
       {"rotation_translation_matrix", mat_array("", 3, 4, {0, 0, -1, 0, 1, 0, 1, 0, 0, 1, 2, z})},
       {"factor_depth", mat_array("", 1, 1, {1000})}}
  );
}

void write_clearpose(const fs::path& folder, bool compressed, const std::string& intrinsics) {
  std::vector<std::string> frames;
  for (int i = 0; i < 9; ++i) {
    const std::string name = fmt::format("{:06}", i);
    const std::string bytes = frame(name, i, intrinsics);
    frames.push_back(compressed ? mat_compressed(bytes) : bytes);
    write_png(
        folder / (name + "-color.png"), Image(kWidth, kHeight, 3, 0.1f * static_cast<float>(i))
    );
    write_png16(
        folder / (name + "-depth_true.png"),
        Image(kWidth, kHeight, 1, static_cast<float>(1500 + i) / 65535)
    );
    write_png16(folder / (name + "-depth.png"), Image(kWidth, kHeight, 1, 0.5f));
  }
  write_file(folder / "metadata.mat", mat_file(frames));
}

}  // namespace

TEST_CASE("a scene of ClearPose has its poses, intrinsics and true depth") {
  for (const bool compressed : {false, true}) {
    const TempFolder folder;
    const char* intrinsics = compressed ? "camera_intrinsics" : "intrinsic_matrix";
    write_clearpose(folder / "scene1", compressed, intrinsics);
    const Scene scene = load_scene(folder / "scene1", {});
    CHECK(scene.dataset == "clearpose");
    REQUIRE(scene.train.size() == 7);
    REQUIRE(scene.test.size() == 2);
    const View& view = scene.test[1];
    CHECK(view.name == "000008");
    CHECK(view.camera.fx == 10);
    CHECK(view.camera.fy == 11);
    CHECK(view.camera.cx == 5.5);
    CHECK(view.camera.cy == 4.25);
    const Vec3d center = view.camera.center();
    CHECK(center.x == Approx(1));
    CHECK(center.y == Approx(2));
    CHECK(center.z == Approx(11));
    // What lies one metre along the world's x is one metre in front.
    const Vec3d seen = view.camera.rotation_cam_from_world * Vec3d{2, 2, 11} +
                       view.camera.translation_cam_from_world;
    CHECK(seen.x == Approx(0).margin(1e-12));
    CHECK(seen.z == Approx(1));
    CHECK(view.truth["depth"].at(3, 3) == Approx(1.508));
    for (const Finding& finding : check_dataset(folder / "scene1"))
      FAIL_CHECK(finding.check << ": " << finding.message);
  }
}

TEST_CASE("a MAT file that is damaged, cut off or of another kind is refused by name") {
  const TempFolder folder;
  const std::string good = mat_file({frame("000000", 0), mat_compressed(frame("000001", 1))});
  const auto message = [&](const std::string& bytes) {
    write_file(folder / "metadata.mat", bytes);
    return bad_reference([&] { read_mat(folder / "metadata.mat"); });
  };
  write_file(folder / "metadata.mat", good);
  CHECK(read_mat(folder / "metadata.mat").at("000001").fields.at("factor_depth").values[0] == 1000);
  for (std::size_t length = 8; length + 8 < good.size(); length += 13) {
    write_file(folder / "metadata.mat", good.substr(0, length));
    std::size_t arrays = 0;
    std::string told;
    try {
      arrays = read_mat(folder / "metadata.mat").size();
    } catch (const Error& error) {
      told = error.what();
    }
    CHECK(arrays < 2);  // what ends between two arrays is whole
    if (arrays == 0 && length != 128)
      CHECK_THAT(told, Contains("metadata.mat: not a whole MAT file"));
  }
  std::string hdf5 = "MATLAB 7.3 MAT-file";
  hdf5.resize(512, ' ');
  CHECK_THAT(message(hdf5), Contains("HDF5"));
  std::string nested = mat_array("", 1, 1, {1});
  for (int i = 0; i < 12; ++i) nested = mat_struct("a", {{"f", nested}});
  CHECK_THAT(message(mat_file({nested})), Contains("nested more than 8 deep"));
  CHECK_THAT(message(mat_file({mat_array("a", 3, 3, {1, 2})})), Contains("does not have the size"));
}

TEST_CASE("frames of ClearPose without a camera are problems that name frame and field") {
  const TempFolder folder;
  write_clearpose(folder / "s", false, "intrinsic_matrix");
  write_png(folder / "s/000100-color.png", Image(kWidth, kHeight, 3, 0.5f));
  CHECK_THAT(
      bad_reference([&] { load_scene(folder / "s", {}); }), Contains("metadata.mat: 000100")
  );
  write_file(
      folder / "s/metadata.mat",
      mat_file({mat_struct("000000", {{"intrinsic_matrix", mat_array("", 1, 2, {1, 2})}})})
  );
  CHECK_THAT(
      bad_reference([&] { load_scene(folder / "s", {}); }),
      Contains("000000") && Contains("3 x 3 finite numbers in 'intrinsic_matrix'")
  );
}

TEST_CASE("RT-Splatting's transparent_masks are the true glass of a COLMAP scene") {
  const TempFolder folder;
  std::string images;
  for (int i = 0; i < 9; ++i) {
    images += fmt::format("{} 1 0 0 0 {} 0 0 1 {:02}.jpg.png\n\n", i + 1, 0.1 * i, i);
    write_png(folder / fmt::format("van/images/{:02}.jpg.png", i), Image(kWidth, kHeight, 3, 0.5f));
    Image mask(kWidth, kHeight, 1);
    mask.at(2 + i % 3, 1) = 1;
    write_png(folder / fmt::format("van/transparent_masks/{:02}.jpg.png", i), mask);
  }
  write_file(folder / "van/sparse/0/images.txt", images);
  write_file(folder / "van/sparse/0/cameras.txt", "1 PINHOLE 12 8 10 10 6 4\n");
  write_file(folder / "van/sparse/0/points3D.txt", "1 0 0 5 128 128 128 0\n");
  const Scene scene = load_scene(folder / "van", {});
  REQUIRE(scene.test.size() == 2);
  const Image& glass = scene.test[1].truth["glass"];
  CHECK(glass.at(4, 1) == 1);
  CHECK(glass.at(2, 1) == 0);
}

TEST_CASE("glint-depth takes GlassRecon's folder as reference, with its scale and its masks") {
  const TempFolder folder;
  const fs::path data = folder / "GlassRecon";
  Image raw(kWidth, kHeight, 1, 2500), found(kWidth, kHeight, 1, 2.0f), mask(kWidth, kHeight, 1);
  raw.at(0, 0) = 0;  // glass that could not be completed
  found.at(3, 3) = 2.5f;
  mask.at(3, 3) = 1;
  write_npy(data / "evaluation_depths/depths_npy/0001.npy", raw);
  write_png(data / "masks/0001.png", mask);
  write_png(data / "images/0001.png", Image(kWidth, kHeight, 3, 0.5f));
  write_npy(folder / "mine/0001.npy", found);
  std::ostringstream out, err;
  for (const char* scale : {"0.001", "1000"}) {
    write_file(
        data / "intrinsics/0001.json",
        fmt::format(R"({{"fx": 10, "fy": 10, "cx": 6, "cy": 4, "depth_scale": {}}})", scale)
    );
    out.str("");
    const auto tool = make_depth_tool();
    REQUIRE(
        run_tool(*tool, {folder / "mine", data, "--glass", data, "--json", "--quiet"}, out, err) ==
        0
    );
    const Json json = Json::parse(out.str());
    const int pixels = kWidth * kHeight - 1;
    CHECK(json["mean"]["depth-absrel"].get<double>() == Approx(0.2 * (pixels - 1) / pixels));
    CHECK(json["mean"]["depth-absrel@glass"].get<double>() == Approx(0).margin(1e-7));
    CHECK(json["protocol"]["depth-absrel"]["reference_steps"]["from"] == "intrinsics/0001.json");
  }
}
