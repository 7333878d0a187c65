// SPDX-License-Identifier: MIT
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "datasets/colmap_model.h"
#include "datasets/dataset.h"
#include "glint/scene/image_files.h"
#include "tests/support/box_room.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

constexpr ImageSize kSize{48, 36};
const std::vector<std::string> kFiles = {"cameras", "images", "points3D"};

// Ten views with a camera each, as .bin and .txt.
struct ColmapFolder : TempFolder {
  std::vector<View> views = box_room_views(10, kSize);
  ColmapModel model;
  PointCloud points{
      {{1, 2, 0.5f}, {3, 2, 1}, {1, 1, 1}, {2, 2, 2}}, {{1, 0, 0.2f}, {}, {}, {}}, {}};

  ColmapFolder() {
    std::uint32_t id = 7;  // ids are not contiguous
    for (const View& view : views) {
      write_png(path() / "images" / (view.name + ".png"), view.rgb);
      const Camera& c = view.camera;
      model.cameras[id] = {kColmapPinhole, 48, 36, {c.fx, c.fy, c.cx, c.cy}};
      model.images.push_back(
          {3 * id,
           id,
           view.name + ".png",
           quaternion_from_rotation(c.rotation_cam_from_world),
           c.translation_cam_from_world}
      );
      ++id;
    }
    store();
  }
  void store() const { write_colmap_model(path() / "sparse/0", model, points); }
  void keep_only(const std::string& extension) const {
    for (const std::string& file : kFiles)
      fs::remove(path() / "sparse/0" / (file + (extension == ".bin" ? ".txt" : ".bin")));
  }
  std::string load_error() const {
    return bad_reference([&] { load_scene(path(), {}); });
  }
  void set_lens(int lens, std::vector<double> params) {
    for (auto& [id, camera] : model.cameras) camera.lens = lens, camera.params = params;
    store();
  }
};

}  // namespace

TEST_CASE("COLMAP folders are loaded from binary and from text files alike") {
  for (const std::string extension : {".bin", ".txt"}) {
    INFO(extension);
    const ColmapFolder folder;
    folder.keep_only(extension);
    CHECK(find_loader(folder.path()).name == "colmap");
    const Scene scene = load_scene(folder.path(), {});
    CHECK(scene.dataset == "colmap");
    REQUIRE(scene.train.size() == 8);
    REQUIRE(scene.test.size() == 2);
    CHECK(scene.test[1].name == "0008");
    const Camera &a = scene.train[2].camera, &b = folder.views[3].camera;
    CHECK(a.fx == b.fx);
    CHECK(length(a.translation_cam_from_world - b.translation_cam_from_world) == 0);
    CHECK(length(a.rotation_cam_from_world.rows[1] - b.rotation_cam_from_world.rows[1]) < 1e-14);
    REQUIRE(scene.points.positions.size() == 4);
    CHECK(scene.points.positions[0].z == 0.5f);
    CHECK(scene.points.colors[0].z == Approx(0.2f));
    CHECK(check_dataset(folder.path()).empty());
  }
}

TEST_CASE("without a list every 8th picture in the order of bytes is a test view") {
  ColmapFolder folder;
  for (std::size_t i = 0; i < 10; ++i) {
    const std::string name = fmt::format("f{}.png", i + 5);  // f10.png comes first
    fs::rename(folder / "images" / folder.model.images[i].name, folder / "images" / name);
    folder.model.images[i].name = name;
  }
  folder.store();
  Scene scene = load_scene(folder.path(), {});
  REQUIRE(scene.test.size() == 2);
  CHECK(scene.test[0].name == "f8");
  CHECK(scene.test[1].name == "f10");
  write_file(folder / "sparse/0/test.txt", "f6.png\r\nf12.png\n\n");
  scene = load_scene(folder.path(), {});
  REQUIRE(scene.test.size() == 2);
  CHECK(scene.test[1].name == "f12");
  CHECK(scene.train.size() == 8);
  write_file(folder / "sparse/0/test.txt", "f6\n");
  CHECK_THAT(folder.load_error(), Contains("test.txt") && Contains("no image is called f6"));
}

TEST_CASE("lenses are undone where they can be, and refused by name elsewhere") {
  ColmapFolder folder;
  folder.set_lens(0, {31, 24, 18});
  CHECK(load_scene(folder.path(), {}).train[0].camera.fy == 31);
  folder.set_lens(3, {31, 24.5, 18.5, 0.01, 0});
  const Scene bent = load_scene(folder.path(), {});
  CHECK(bent.train[0].camera.fx == 31);
  CHECK(bent.train[0].rgb.size() != kSize);  // undistorted and cropped
  folder.set_lens(4, {31, 32, 24, 18, 0, 0, 0, 0});
  CHECK(load_scene(folder.path(), {}).train[0].camera.fy == 32);
  folder.set_lens(5, {31, 32, 24, 18, 0, 0, 0, 0});
  CHECK_THAT(folder.load_error(), Contains("OPENCV_FISHEYE; undistort the images"));
  folder.set_lens(6, {31, 32, 24, 18, 0, 0, 0, 0, 0, 0.1, 0, 0});
  CHECK_THAT(folder.load_error(), Contains("FULL_OPENCV"));
  folder.model.cameras.erase(9);
  folder.set_lens(1, {31, 32, 24, 18});
  CHECK_THAT(folder.load_error(), Contains("camera 9 is not in the file"));
}

TEST_CASE("cut-off and damaged COLMAP files are errors that name the file") {
  for (const std::string& file : kFiles)
    for (const std::string extension : {".bin", ".txt"}) {
      const ColmapFolder folder;
      folder.keep_only(extension);
      const fs::path path = folder.path() / "sparse/0" / (file + extension);
      const std::string text = read_file(path);
      INFO(path);
      if (extension == ".txt") {
        write_file(path, "# nothing\n1 2 x\n");
        CHECK_THAT(folder.load_error(), Contains(file + ".txt"));
        continue;
      }
      for (std::size_t length = 0; length < text.size(); length += 37) {
        write_file(path, text.substr(0, length));
        CHECK_THAT(folder.load_error(), Contains(file + ".bin"));
      }
      write_file(path, std::string(8, '\x7f') + text.substr(8));  // a number that nothing holds
      CHECK_THAT(folder.load_error(), Contains("bytes are left"));
    }
}

TEST_CASE("COLMAP text that ends early is an error, wherever it ends") {
  for (const std::string& file : kFiles) {
    const ColmapFolder folder;
    folder.keep_only(".txt");
    const fs::path path = folder.path() / "sparse/0" / (file + ".txt");
    const std::string text = read_file(path);
    // Behind the line that states a count, up to the last value.
    const std::size_t begin = text.find('\n', text.find("# Number of"));
    for (std::size_t length = begin; length < text.rfind(' '); ++length) {
      write_file(path, text.substr(0, length));
      INFO(file << " cut at " << length);
      CHECK_THAT(folder.load_error(), Contains(file + ".txt"));
    }
  }
}

TEST_CASE("rows of points and observations that lack columns are errors, also without a count") {
  const ColmapFolder folder;
  folder.keep_only(".txt");
  const auto error_of_points = [&](const char* row) {
    write_file(folder / "sparse/0/points3D.txt", row);
    return folder.load_error();
  };
  CHECK_THAT(error_of_points("1 0 0 0 9 9 9\n"), Contains("line 1: a value is missing"));
  CHECK_THAT(error_of_points("1 0 0 0 9 9 9 0.5 3\n"), Contains("line 1: a value is missing"));
  write_file(folder / "sparse/0/points3D.txt", "1 0 0 0 9 9 9 0.5 3 1\n");
  CHECK(load_scene(folder.path(), {}).points.positions.size() == 1);
}

TEST_CASE("a rotation whose quaternion is not of unit length is an error that names the image") {
  ColmapFolder folder;
  folder.model.images[3].rotation_cam_from_world.w *= 0.5;
  folder.store();
  CHECK_THAT(folder.load_error(), Contains("0003.png: its quaternion has length"));
}

TEST_CASE("a model beside another format's files leaves the folder to that format") {
  const ColmapFolder folder;
  write_nerfstudio(folder.path(), folder.views);
  CHECK(find_loader(folder.path()).name == "nerfstudio");
  CHECK(load_scene(folder.path(), {.loader = "colmap"}).dataset == "colmap");
}

TEST_CASE("names with the backslashes of Windows are those of files in folders") {
  ColmapFolder folder;
  fs::create_directories(folder / "images/left");
  for (ColmapImage& image : folder.model.images) {
    fs::rename(folder / "images" / image.name, folder / "images/left" / image.name);
    image.name = "left\\" + image.name;
  }
  folder.store();
  write_file(folder / "sparse/0/test.txt", "left\\0004.png\r\n");
  const Scene scene = load_scene(folder.path(), {});
  REQUIRE(scene.test.size() == 1);
  CHECK(scene.test[0].name == "0004");
  CHECK(check_dataset(folder.path()).empty());
}

TEST_CASE("a picture's name that is not UTF-8 is refused by name, by the check and by loading") {
  ColmapFolder folder;
  const std::string name = "caf\xe9.png";  // Latin-1
  fs::rename(folder / "images" / folder.model.images[3].name, folder / "images" / name);
  folder.model.images[3].name = name;
  folder.store();
  CHECK_THAT(folder.load_error(), Contains("caf\\xe9.png") && Contains("is not UTF-8"));
  const auto findings = check_dataset(folder.path());
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].check == "view-name");
  CHECK_THAT(findings[0].where, Contains("images.bin") || Contains("sparse/0"));
}

TEST_CASE(
    "pictures of another size than stated are scaled with a note, and found where they are cut"
) {
  const ColmapFolder folder;
  const auto resize_all = [&](ImageSize size, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
      write_png(
          folder / "images" / folder.model.images[i].name,
          Image(size.width, size.height, 3, 0.1f * static_cast<float>(i))
      );
  };
  CHECK(load_scene(folder.path(), {}).data_notes.empty());
  resize_all({24, 18}, 10);  // half of it, all of them
  const Scene half = load_scene(folder.path(), {});
  CHECK(half.train[0].camera.fx == Approx(folder.views[1].camera.fx / 2));
  REQUIRE(half.data_notes.size() == 1);
  CHECK_THAT(half.data_notes[0], Contains("10 of 10 pictures") && Contains("a ratio of 0.5"));
  CHECK(check_dataset(folder.path()).empty());
  resize_all({47, 36}, 10);  // a column is cut off
  const Scene cut = load_scene(folder.path(), {});
  REQUIRE(cut.data_notes.size() == 1);
  CHECK_THAT(cut.data_notes[0], Contains("ratios 0.9792 of the width and 1 of the height"));
  const auto findings = check_dataset(folder.path());
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].check == "intrinsics-size");
  CHECK_THAT(findings[0].message, Contains("10 of 10 pictures") && Contains("cut"));
}

TEST_CASE("some pictures of another size than stated, where others are as stated, are found") {
  const ColmapFolder folder;
  for (const std::size_t i : {2u, 5u})
    write_png(
        folder / "images" / folder.model.images[i].name,
        Image(24, 18, 3, 0.1f * static_cast<float>(i))
    );
  CHECK_THAT(load_scene(folder.path(), {}).data_notes.at(0), Contains("2 of 10 pictures"));
  const auto findings = check_dataset(folder.path());
  REQUIRE(findings.size() == 1);
  CHECK_THAT(findings[0].message, Contains("2 of 10 pictures are of another size than stated"));
}

TEST_CASE("points in another unit than the poses are found") {
  ColmapFolder folder;
  for (const float scale : {1000.0f, 0.001f}) {
    PointCloud points = folder.points;
    for (Vec3f& position : points.positions) position = scale * position;
    write_colmap_model(folder / "sparse/0", folder.model, points);
    const auto findings = check_dataset(folder.path());
    CHECK(std::ranges::any_of(findings, [](const Finding& finding) {
      return finding.check == "points" &&
             finding.message.find("both in one unit") != std::string::npos;
    }));
  }
}
