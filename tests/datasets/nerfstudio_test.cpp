// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <cmath>

#include "datasets/dataset.h"
#include "datasets/undistort.h"
#include "glint/core/config.h"
#include "glint/scene/image_files.h"
#include "glint/scene/image_files_stored.h"
#include "glint/scene/ply.h"
#include "tests/support/box_room.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

constexpr ImageSize kSize{48, 36};

struct RoomFolder : TempFolder {
  std::vector<View> views = box_room_views(10, kSize);
  Json json;
  RoomFolder() {
    write_nerfstudio(path(), views);
    json = Json::parse(read_file(path() / "transforms.json"));
  }

  Scene load(const LoadOptions& options = {}) const {
    write_file(path() / "transforms.json", json.dump());
    return load_scene(path(), options);
  }
  std::string load_error() const {
    return bad_reference([&] { load(); });
  }
};

double pose_difference(const Camera& a, const Camera& b) {
  double largest = length(a.translation_cam_from_world - b.translation_cam_from_world);
  for (int i = 0; i < 3; ++i)
    largest = std::max(
        largest, length(a.rotation_cam_from_world.rows[i] - b.rotation_cam_from_world.rows[i])
    );
  return largest;
}

// Where a lens with OpenCV's model puts the image point (x, y) of a pinhole camera.
Vec2d distort(const Camera& c, const std::vector<double>& k, double px, double py) {
  const double x = (px - c.cx) / c.fx, y = (py - c.cy) / c.fy, r2 = x * x + y * y;
  const double radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double dx = 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x);
  const double dy = k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y;
  return {c.fx * (x * radial + dx) + c.cx, c.fy * (y * radial + dy) + c.cy};
}

}  // namespace

TEST_CASE("OpenGL camera-to-world matrices become our poses") {
  const RoomFolder folder;
  const Scene scene = folder.load();
  CHECK(scene.dataset == "nerfstudio");
  REQUIRE(scene.train.size() == 8);
  REQUIRE(scene.test.size() == 2);
  CHECK(scene.test[1].name == "0008");
  CHECK(pose_difference(scene.train[2].camera, folder.views[3].camera) < 1e-12);
  CHECK(scene.train[2].camera.fx == folder.views[3].camera.fx);
  CHECK(
      scene.train[2].rgb.at(7, 9, 1) ==
      Approx(folder.views[3].rgb.at(7, 9, 1)).margin(0.5 / 255 + 1e-6)
  );
  CHECK(scene.points.positions.empty());
}

TEST_CASE("intrinsics may stand in the frame, follow from an angle, or from the image") {
  RoomFolder folder;
  const double fx = folder.views[0].camera.fx;
  folder.json["frames"][3]["fl_x"] = 2 * fx;
  Scene scene = folder.load();
  CHECK(scene.train[2].camera.fx == 2 * fx);
  CHECK(scene.train[1].camera.fx == fx);
  for (const char* key : {"fl_x", "fl_y", "cx", "cy", "w", "h"}) folder.json.erase(key);
  folder.json["frames"][3].erase("fl_x");
  CHECK_THAT(folder.load_error(), Contains("no focal length"));
  folder.json["camera_angle_x"] = 75 * 3.14159265358979323846 / 180;
  scene = folder.load();
  CHECK(scene.train[0].camera.fx == Approx(fx));
  CHECK(scene.train[0].camera.fy == Approx(fx));
  CHECK(scene.train[0].camera.cx == 24);
}

TEST_CASE("intrinsics follow images that were scaled, not images of another shape") {
  RoomFolder folder;
  for (const char* key : {"w", "h", "fl_x", "fl_y", "cx", "cy"})
    folder.json[key] = 3 * folder.json[key].get<double>();
  const Scene scene = folder.load();
  CHECK(scene.train[0].camera.size() == kSize);
  CHECK(scene.train[0].camera.fx == Approx(folder.views[0].camera.fx));
  CHECK(scene.train[0].camera.cy == Approx(18));
  folder.json["h"] = 3 * 48;
  CHECK_THAT(folder.load_error(), Contains("144 x 144") && Contains("48 x 36"));
}

TEST_CASE("file names may lack their extension, and equal stems keep their folder") {
  RoomFolder folder;
  folder.json["frames"][0]["file_path"] = "./images/0000";
  fs::create_directory(folder / "more");
  fs::copy_file(folder / "images/0000.png", folder / "more/0001.png");
  folder.json["frames"].push_back(folder.json["frames"][0]);
  folder.json["frames"][10]["file_path"] = "more/0001.png";
  const Scene scene = folder.load();
  CHECK(scene.test[0].name == "0000");
  CHECK(scene.train[0].name == "images_0001");
  CHECK(scene.train.back().name == "more_0001");
}

TEST_CASE("lenses of instant-ngp that are not OpenCV's are refused by name") {
  RoomFolder folder;
  folder.json["is_fisheye"] = false;
  CHECK(folder.load().train.size() == 8);
  folder.json["is_fisheye"] = true;
  CHECK_THAT(folder.load_error(), Contains("is_fisheye is true") && Contains("undistort"));
}

// 4 x 3 pixels of one colour, half transparent.
constexpr unsigned char kRgbaPng[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44,
    0x52, 0x00, 0x00, 0x00, 0x04, 0x00, 0x00, 0x00, 0x03, 0x08, 0x06, 0x00, 0x00, 0x00, 0xb4,
    0xf4, 0xae, 0xc6, 0x00, 0x00, 0x00, 0x11, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x68,
    0x70, 0x50, 0xa8, 0x47, 0xc6, 0x0c, 0x04, 0x05, 0x00, 0xa4, 0xa2, 0x10, 0x75, 0x84, 0x3f,
    0x55, 0xc8, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

TEST_CASE("pictures with an alpha channel are told of") {
  const RoomFolder folder;
  CHECK(folder.load().data_notes.empty());
  write_file(folder / "images/0003.png", std::string(std::begin(kRgbaPng), std::end(kRgbaPng)));
  CHECK(has_alpha(folder / "images/0003.png"));
  CHECK_FALSE(has_alpha(folder / "images/0004.png"));
  CHECK_FALSE(has_alpha(folder / "transforms.json"));
  const Scene scene = folder.load();
  CHECK(scene.train[2].rgb.at(1, 1, 0) == Approx(128.0 / 255 * 127 / 255));  // on black
  REQUIRE(scene.data_notes.size() == 2);  // it is smaller than its camera says, too
  CHECK_THAT(scene.data_notes[0], Contains("1 of 10 pictures are of another size"));
  CHECK_THAT(scene.data_notes[1], Contains("1 of 10 pictures have an alpha channel"));
}

TEST_CASE("split lists rule where there are any") {
  RoomFolder folder;
  folder.json["train_filenames"] = {"images/0001.png", "images/0002.png"};
  folder.json["val_filenames"] = {"./images/0003.png"};
  Scene scene = folder.load();
  CHECK(scene.train.size() == 2);
  REQUIRE(scene.test.size() == 1);
  CHECK(scene.test[0].name == "0003");
  folder.json["test_filenames"] = {"images/0004.png"};
  scene = folder.load();
  REQUIRE(scene.test.size() == 1);
  CHECK(scene.test[0].name == "0004");
  folder.json["train_filenames"] = {"images/0001.png", "images/0004.png"};
  scene = folder.load();
  CHECK(scene.train.size() == 2);
  CHECK(scene.test.empty());  // what trains is not scored
  REQUIRE(scene.data_notes.size() == 1);
  CHECK_THAT(scene.data_notes[0], Contains("1 views are listed as train and as test"));
  LoadOptions test_only;
  test_only.test_only = true;
  CHECK(folder.load(test_only).test.empty());
  folder.json["train_filenames"] = {"images/0001.png", "0002.png"};
  CHECK_THAT(
      folder.load_error(), Contains("train_filenames: 1 of 2 names") && Contains("'0002.png'")
  );
  folder.json["train_filenames"] = "images/0001.png";
  CHECK_THAT(folder.load_error(), Contains("train_filenames: expected a list"));
}

TEST_CASE("a point cloud is read where the file names one") {
  RoomFolder folder;
  write_point_ply(folder / "sparse.ply", {{{1, 2, 3}, {4, 5, 6}}, {{0, 0, 0}, {1, 1, 1}}, {}});
  folder.json["ply_file_path"] = "sparse.ply";
  CHECK(folder.load().points.positions.size() == 2);
  folder.json["ply_file_path"] = "none.ply";
  CHECK_THAT(folder.load_error(), Contains("none.ply: no such file"));
}

TEST_CASE("damaged transforms are errors that name file and field") {
  const auto changes = Json::parse(R"([
    ["remove", "/frames", null, "transforms.json: frames: expected a list"],
    ["replace", "/frames", [], "no train views"],
    ["remove", "/frames/4/transform_matrix", null, "frame 4: transform_matrix: expected 4 x 4"],
    ["replace", "/frames/4/transform_matrix/1/3", null, "found null"],
    ["replace", "/frames/4/transform_matrix/1/1", 5, "images/0004.png"],
    ["replace", "/frames/4/transform_matrix/1/1", 5, "no rotation"],
    ["replace", "/fl_x", "wide", "fl_x is \"wide\""],
    ["remove", "/frames/4/file_path", null, "frame 4: file_path"],
    ["add", "/camera_model", "OPENCV_FISHEYE", "undistort the images"],
    ["replace", "/frames/4/file_path", "images/none.png", "images/none.png: no such file"]
  ])");
  RoomFolder folder;
  const Json good = folder.json;
  for (const Json& change : changes) {
    const Json operation{{"op", change[0]}, {"path", change[1]}, {"value", change[2]}};
    folder.json = good.patch(Json::array({operation}));
    CHECK_THAT(folder.load_error(), Contains(change[3].get<std::string>()));
  }
}

TEST_CASE("undistortion looks up every pixel where the lens put it") {
  Camera camera = box_room_views(1, {200, 150})[0].camera;
  camera.cx = 104;
  camera.cy = 71;
  const std::vector<double> k{0.06, -0.05, -0.001, 0.002, 0.01};
  // The photograph of a ramp: its value tells where a pixel was looked up.
  Image ramp(200, 150, 2);
  for (int y = 0; y < 150; ++y)
    for (int x = 0; x < 200; ++x) {
      ramp.at(x, y, 0) = static_cast<float>(x) + 0.5f;
      ramp.at(x, y, 1) = static_cast<float>(y) + 0.5f;
    }
  const Undistortion undistortion(camera, k);
  const Camera& straight = undistortion.camera();
  const Image result = undistortion.apply(ramp, Undistortion::Lookup::kBilinear);
  REQUIRE(result.size() == straight.size());
  CHECK(straight.fx == camera.fx);
  CHECK(straight.width < 200);  // this lens leaves empty borders, which are cropped
  CHECK(straight.width > 180);
  for (int y = 0; y < straight.height; y += 7)
    for (int x = 0; x < straight.width; x += 7) {
      const Vec3d ray = straight.ray_in_cam(x + 0.5, y + 0.5);
      const Vec2d expected =
          distort(camera, k, ray.x * camera.fx + camera.cx, ray.y * camera.fy + camera.cy);
      // OpenCV interpolates at 1/32 pixel.
      CHECK(static_cast<double>(result.at(x, y, 0)) == Approx(expected.x).margin(1.0 / 32));
      CHECK(static_cast<double>(result.at(x, y, 1)) == Approx(expected.y).margin(1.0 / 32));
    }
}

TEST_CASE("p1 and p2 reach the lens model unswapped, and a hopeless lens is an error") {
  RoomFolder folder;
  folder.json["p1"] = 0.01;
  const Scene scene = folder.load();
  const Undistortion expected(folder.views[1].camera, std::vector<double>{0, 0, 0.01, 0, 0});
  const Image image =
      expected.apply(read_image(folder / "images/0001.png", 3), Undistortion::Lookup::kBilinear);
  const Image& loaded = scene.train[0].rgb;
  REQUIRE(loaded.size() == image.size());
  CHECK(std::equal(image.values().begin(), image.values().end(), loaded.values().begin()));
  folder.json["k1"] = 50;
  CHECK_THAT(folder.load_error(), Contains("distortion coefficients") && Contains("frame"));
  const auto findings = check_dataset(folder.path());
  CHECK(std::any_of(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.check == "distortion";
  }));
}

TEST_CASE("a principal point far from the middle is loaded with a note, and found by the check") {
  RoomFolder folder;
  CHECK(folder.load().data_notes.empty());
  folder.json["cx"] = 0.9 * folder.json["w"].get<double>();
  const Scene scene = folder.load();
  REQUIRE(scene.data_notes.size() == 1);
  CHECK_THAT(
      scene.data_notes[0],
      Contains(fmt::format("of {0} of {0} views", scene.train.size() + scene.test.size()))
  );
  const auto findings = check_dataset(folder.path());
  REQUIRE_FALSE(findings.empty());
  CHECK(findings[0].check == "intrinsics-size");
}

TEST_CASE("real captures are loaded") {
  for (const std::string name : {"fox", "barcelona_pavilion"}) {
    const fs::path folder = fs::path("../shared/data") / name;
    if (!fs::exists(folder)) {
      WARN("skipped: " << folder << " is not there");
      continue;
    }
    LoadOptions options;
    options.max_pixels = 20000;
    const Scene scene = load_scene(folder, options);
    CHECK(scene.train.size() + scene.test.size() == (name == "fox" ? 50 : 100));
    CHECK(scene.train[0].rgb.num_pixels() <= 20000);
    CHECK(scene.name == name);
    CHECK(check_dataset(folder).empty());
  }
}

TEST_CASE("pictures that are there in smaller copies alone are taken from the largest") {
  RoomFolder folder;
  for (const char* key : {"w", "h", "fl_x", "fl_y", "cx", "cy"})
    folder.json[key] = 4 * folder.json[key].get<double>();
  fs::rename(folder / "images", folder / "images_4");
  Scene scene = folder.load();
  CHECK(scene.train[0].camera.size() == kSize);
  CHECK(scene.train[0].camera.fx == Approx(folder.views[0].camera.fx));
  for (const View& view : folder.views)
    write_png(folder / "images_2" / (view.name + ".png"), Image(96, 72, 3));
  scene = folder.load();
  CHECK(scene.train[0].camera.size() == ImageSize{96, 72});
}

TEST_CASE("a scene of DL3DV's benchmark is known by its folders") {
  RoomFolder folder;
  const TempFolder outer;
  folder.load();
  fs::create_directories(outer / "abc123/gaussian_splat");
  fs::copy(folder.path(), outer / "abc123/nerfstudio", fs::copy_options::recursive);
  fs::rename(outer / "abc123/nerfstudio/images", outer / "abc123/nerfstudio/images_8");
  const Scene scene = load_scene(outer / "abc123", {});
  CHECK(scene.dataset == "dl3dv");
  CHECK(scene.name == "abc123");
  CHECK(scene.train.size() == 8);
  CHECK(find_loader(outer / "abc123/nerfstudio").name == "nerfstudio");
  const Json said{{"test_views", {scene.train[3].name}}};  // obeyed in the folder of any loader
  write_file(outer / "abc123/scene.json", said.dump());
  CHECK(load_scene(outer / "abc123", {}).test.at(0).name == scene.train[3].name);
  CHECK(load_scene(outer / "abc123", {}).test.size() == 1);
}

TEST_CASE("distortion may stand in a list, in its own order") {
  RoomFolder folder;
  folder.json["k1"] = 0.05;
  folder.json["p1"] = 0.01;
  folder.json["k3"] = 0.02;
  const Scene single = folder.load();
  for (const char* key : {"k1", "p1", "k3"}) folder.json.erase(key);
  folder.json["distortion_params"] = {0.05, 0, 0.02, 0, 0.01, 0};
  const Scene list = folder.load();
  CHECK(list.train[0].camera.size() == single.train[0].camera.size());
  CHECK(list.train[0].rgb.at(5, 5, 0) == single.train[0].rgb.at(5, 5, 0));
  folder.json["distortion_params"] = {0.05, 0, 0, 0.1, 0, 0};
  CHECK_THAT(folder.load_error(), Contains("k4 = 0"));
  folder.json["distortion_params"] = {0.05, 0};
  CHECK_THAT(folder.load_error(), Contains("k1 k2 k3 k4 p1 p2"));
}

TEST_CASE("pictures outside of the folder are refused, links inside are not") {
  RoomFolder folder;
  const TempFolder outside;
  fs::copy_file(folder / "images/0000.png", outside / "secret.png");
  folder.json["frames"][0]["file_path"] = (outside / "secret.png").string();
  CHECK_THAT(folder.load_error(), Contains("lies outside of"));
  folder.json["frames"][0]["file_path"] =
      "../" + outside.path().filename().string() + "/secret.png";
  CHECK_THAT(folder.load_error(), Contains("lies outside of"));
  folder.json["frames"][0]["file_path"] = "images/0000.png";
  folder.json["ply_file_path"] = "../elsewhere.ply";
  CHECK_THAT(folder.load_error(), Contains("elsewhere.ply lies outside of"));
  folder.json.erase("ply_file_path");
  fs::create_symlink(outside / "secret.png", folder / "images/link.png");
  folder.json["frames"][0]["file_path"] = "images/link.png";
  CHECK(folder.load().test.size() == 2);
}

TEST_CASE("true depth beside a capture is EXR, NPY or PNG in stated steps, where scene.json says so"
) {
  RoomFolder folder;
  const Image& depth = folder.views[1].truth["depth"];
  Image steps(depth.width(), depth.height(), 1);
  for (std::size_t i = 0; i < depth.num_pixels(); ++i)
    steps.data()[i] = std::round(depth.data()[i] / 0.0005f) / 65535;
  for (const View& view : folder.views) {
    write_png16(folder / "depths" / (view.name + ".png"), steps);
    if (view.name == "0002") fs::remove(folder / "depths/0002.png");
    if (view.name == "0003") fs::remove(folder / "depths/0003.png");
  }
  write_exr(folder / "depths/0002.exr", depth);
  write_npy(folder / "depths/0003.npy", depth);
  CHECK(folder.load().train[0].truth["depth"].empty());
  write_file(folder / "scene.json", R"({"side_maps": true, "depth_scale": 0.0005})");
  const Scene scene = folder.load();
  CHECK(scene.train[0].truth["depth"].at(7, 9) == Approx(depth.at(7, 9)).margin(0.0003));
  CHECK(scene.train[1].truth["depth"].at(7, 9) == depth.at(7, 9));
  CHECK(scene.train[2].truth["depth"].at(7, 9) == depth.at(7, 9));
  write_file(folder / "scene.json", R"({"side_maps": true, "depth_scale": 0})");
  CHECK_THAT(folder.load_error(), Contains("depth_scale is 0"));
}

namespace {

// White but for the left half.
MaskImage left_half_out(ImageSize size) {
  MaskImage mask(size.width, size.height, 1, 255);
  for (int y = 0; y < size.height; ++y) std::fill_n(mask.pixel(0, y), size.width / 2, 0);
  return mask;
}

}  // namespace

TEST_CASE("masks say which pixels count; what others show is grey and in no map") {
  RoomFolder folder;
  write_png(folder / "masks/2.png", map_of_mask(left_half_out(kSize)));
  write_png(folder / "masks/all.png", Image(48, 36, 1, 1.0f));
  folder.json["frames"][2]["mask_path"] = "masks/2.png";
  folder.json["frames"][5]["mask_path"] = "./masks/all.png";
  Scene scene = folder.load();
  const View& view = scene.train[1];
  REQUIRE(view.counted.size() == kSize);
  CHECK(view.counted.at(23, 7) == 0);
  CHECK(view.counted.at(24, 7) == 1);
  CHECK(view.rgb.at(3, 7, 1) == 0.5f);
  CHECK(view.rgb.at(30, 7, 1) == Approx(folder.views[2].rgb.at(30, 7, 1)).margin(0.003));
  CHECK(scene.train[0].counted.empty());
  CHECK(scene.train[4].counted.empty());  // all of its pixels count
  REQUIRE(scene.data_notes.size() == 1);
  CHECK_THAT(scene.data_notes[0], Contains("1 of 8 train views (6.2 % of all their pixels)"));
  CHECK(check_dataset(folder.path()).empty());
  const std::string hash = scene.spec_hash;
  write_png(folder / "masks/2.png", Image(48, 36, 1, 1.0f));
  CHECK(folder.load().spec_hash != hash);
}

TEST_CASE("nothing that does not count bleeds into pixels of a smaller picture") {
  RoomFolder folder;
  Image picture(48, 36, 3, 0.25f);  // 16 columns of white, which do not count
  MaskImage mask(48, 36, 1, 255);
  for (int y = 0; y < 36; ++y)
    for (int x = 0; x < 17; ++x) {
      mask.at(x, y) = 0;
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = 1;
    }
  write_png(folder / "images/0002.png", picture);
  write_png(folder / "masks/2.png", map_of_mask(mask));
  folder.json["frames"][2]["mask_path"] = "masks/2.png";
  LoadOptions options;
  options.size = {16, 12};
  const View view = folder.load(options).train[1];
  CHECK(view.counted.at(5, 3) == 0);
  CHECK(view.counted.at(6, 3) == 1);
  for (int x = 6; x < 16; ++x) CHECK(view.rgb.at(x, 3, 0) == Approx(0.25f).margin(0.003));
}

TEST_CASE("nothing that does not count bleeds into pixels where a lens is undone") {
  RoomFolder folder;
  folder.json["k1"] = 0.15;
  Image picture(48, 36, 3, 0.25f);
  MaskImage mask(48, 36, 1, 255);
  for (int y = 10; y < 25; ++y)
    for (int x = 9; x < 21; ++x) {
      mask.at(x, y) = 0;
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = 1;
    }
  write_png(folder / "images/0002.png", picture);
  write_png(folder / "masks/2.png", map_of_mask(mask));
  folder.json["frames"][2]["mask_path"] = "masks/2.png";
  const View view = folder.load().train[1];
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < view.counted.num_pixels(); ++i) {
    if (view.counted.data()[i] == 0)
      ++left_out;
    else
      CHECK(view.rgb.data()[3 * i] == Approx(0.25f).margin(0.003));
  }
  CHECK(left_out > 100);
  CHECK(left_out < 300);
}

TEST_CASE(
    "a mask of another size but the same shape serves, one of another shape or without white "
    "is an error that check names, too"
) {
  RoomFolder folder;
  folder.json["frames"][2]["mask_path"] = "masks/2.png";
  const auto check_ids = [&] {
    std::vector<std::string> ids;
    for (const Finding& finding : check_dataset(folder.path())) ids.push_back(finding.check);
    return ids;
  };
  CHECK_THAT(folder.load_error(), Contains("masks/2.png: no such file"));
  CHECK(check_ids() == std::vector<std::string>{"missing-file"});
  write_png(folder / "masks/2.png", map_of_mask(left_half_out({96, 72})));
  CHECK(folder.load().train[1].counted.at(23, 7) == 0);
  CHECK(check_ids().empty());
  write_png(folder / "masks/2.png", Image(36, 48, 1, 1.0f));
  CHECK_THAT(folder.load_error(), Contains("36 x 48 pixels") && Contains("48 x 36"));
  CHECK(check_ids() == std::vector<std::string>{"mask-path"});
  write_png(folder / "masks/2.png", Image(48, 36, 1));
  CHECK_THAT(folder.load_error(), Contains("no pixel counts"));
  CHECK(check_ids() == std::vector<std::string>{"mask-path"});
  folder.json["frames"][2]["mask_path"] = "../2.png";
  CHECK_THAT(folder.load_error(), Contains("lies outside of"));
  folder.json["frames"][2]["mask_path"] = 7;
  CHECK_THAT(folder.load_error(), Contains("mask_path: expected a text"));
}

TEST_CASE("the mask of what counts is no mask of glass, whatever its folder") {
  RoomFolder folder;
  write_file(folder / "scene.json", R"({"side_maps": true})");
  for (int i = 0; i < 10; ++i)
    write_png(folder / fmt::format("masks/{:04}.png", i), map_of_mask(left_half_out(kSize)));
  CHECK(folder.load().train[1].truth.has("glass"));
  for (int i = 0; i < 10; ++i)
    folder.json["frames"][i]["mask_path"] = fmt::format("masks/{:04}.png", i);
  const Scene scene = folder.load();
  CHECK_FALSE(scene.train[1].truth.has("glass"));
  CHECK_FALSE(scene.train[1].counted.empty());
}
