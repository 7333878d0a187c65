// SPDX-License-Identifier: MIT
// What real captures leave behind in a transforms.json and its pictures.
#include <catch2/catch.hpp>

#include "datasets/dataset.h"
#include "glint/core/config.h"
#include "glint/scene/image_files.h"
#include "tests/support/box_room.h"
#include "tests/support/exif.h"
#include "tests/support/rgba_png.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

struct Capture : TempFolder {
  Json json;
  Capture() {
    write_nerfstudio(path(), box_room_views(10, {48, 36}));
    json = Json::parse(read_file(path() / "transforms.json"));
  }
  void store() const { write_file(path() / "transforms.json", json.dump()); }
  Scene load() const { return load_scene(path(), {}); }
};

}  // namespace

TEST_CASE("paths with backslashes are read, of pictures, masks, points and lists alike") {
  Capture capture;
  for (Json& frame : capture.json["frames"]) {
    const fs::path file = frame["file_path"].get<std::string>();
    frame["file_path"] = "images\\" + file.filename().string();
  }
  Image left(48, 36, 1, 1.0f);
  std::fill_n(left.data(), 48 * 18, 0.0f);
  write_png(capture / "masks/left.png", left);
  capture.json["frames"][3]["mask_path"] = "masks\\left.png";
  const std::string test = capture.json["frames"][5]["file_path"];
  capture.json["test_filenames"] = Json::array({test});
  capture.store();
  const Scene scene = capture.load();
  REQUIRE(scene.test.size() == 1);
  CHECK(scene.test[0].name == "0005");
  CHECK(scene.train.size() == 9);
  REQUIRE(scene.data_notes.size() == 1);
  CHECK_THAT(scene.data_notes[0], Contains("1 of 9 train views"));
  CHECK(check_dataset(capture.path()).empty());
}

TEST_CASE("photos that EXIF turns are told of, and a size that does not fit names it as the cause"
) {
  Capture capture;
  const fs::path file = capture / "images/0003.png";
  write_file(file, png_with_exif(read_file(file), 3, true));
  const Scene scene = capture.load();
  REQUIRE(scene.data_notes.size() == 1);
  CHECK_THAT(
      scene.data_notes[0],
      Contains("1 of 10 pictures") && Contains("0003.png: EXIF orientation 3") &&
          Contains("as COLMAP and PIL do")
  );
  write_png(file, Image(36, 48, 3, 0.5f));
  write_file(file, png_with_exif(read_file(file), 6, false));
  const std::string error = bad_reference([&] { capture.load(); });
  CHECK_THAT(
      error, Contains("36 x 48") && Contains("EXIF orientation 6") && Contains("likely cause")
  );
  const auto findings = check_dataset(capture.path());
  REQUIRE(findings.size() == 1);
  CHECK_THAT(findings[0].message, Contains("EXIF orientation 6"));
}

TEST_CASE("a scene whose folder's name is not UTF-8 is refused by the check and by loading") {
  const Capture capture;
  const fs::path folder = capture / "caf\xe9";
  write_nerfstudio(folder, box_room_views(10, {48, 36}));
  CHECK_THAT(
      bad_reference([&] { load_scene(folder, {}); }),
      Contains("is not UTF-8") && Contains("rename the folder")
  );
  const auto findings = check_dataset(folder);
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].check == "scene-name");
  write_file(folder / "scene.json", R"({"name": "cafe"})");  // the path stays
  CHECK_THAT(bad_reference([&] { load_scene(folder, {}); }), Contains("caf\\xe9' is not UTF-8"));
}

namespace {

// Opaque above, a quarter there in the middle, nothing below, each with a colour of its own.
Rgba pane(int, int y) {
  if (y < 12) return {200, 100, 50, 255};
  return y < 24 ? Rgba{160, 80, 240, 64} : Rgba{255, 0, 255, 0};
}

struct AlphaCapture : Capture {
  AlphaCapture() { write_file(path() / "images/0003.png", rgba_png(48, 36, pane)); }
  // By what scene.json says.
  const View& with(const std::string& scene_json) {
    write_file(path() / "scene.json", scene_json);
    scene = load();
    return scene.train.at(2);
  }
  Scene scene;
};

}  // namespace

TEST_CASE("transparent pictures are laid on black, on white, or masked, as the folder says") {
  AlphaCapture capture;
  const View& black = capture.with("{}");
  REQUIRE(black.name == "0003");
  CHECK(black.rgb.at(5, 5, 0) == Approx(200 / 255.0));
  CHECK(black.rgb.at(5, 20, 2) == Approx(240 / 255.0 * 64 / 255));
  CHECK(black.rgb.at(5, 30, 0) == 0);  // not what the file has there
  CHECK_THAT(
      capture.scene.data_notes.at(0),
      Contains("1 of 10 pictures have an alpha channel: they are laid on black")
  );
  const std::string hash = capture.scene.spec_hash;
  const View& white = capture.with(R"({"alpha": "white"})");
  CHECK(white.rgb.at(5, 20, 2) == Approx((240.0 * 64 + 255.0 * (255 - 64)) / (255 * 255)));
  CHECK(white.rgb.at(5, 30, 1) == 1);
  CHECK(capture.scene.spec_hash != hash);
  LoadOptions options;
  options.background = "black";  // goes before what the folder says
  const Scene asked = load_scene(capture.path(), options);
  CHECK(asked.spec_hash == hash);
  CHECK(asked.train.at(2).rgb.at(5, 30, 1) == 0);
  options.background = "green";
  CHECK_THAT(
      bad_reference([&] { load_scene(capture.path(), options); }), Contains("background is 'green'")
  );
  const View& stored = capture.with(R"({"alpha": "stored"})");
  CHECK(stored.rgb.at(5, 30, 2) == 1);
  CHECK(stored.rgb.at(5, 30, 1) == 0);
  const View& masked = capture.with(R"({"alpha": "mask"})");
  REQUIRE_FALSE(masked.counted.empty());
  CHECK(masked.counted.at(5, 5) == 1);
  CHECK(masked.counted.at(5, 20) == 0);
  CHECK(masked.rgb.at(5, 5, 0) == Approx(200 / 255.0));
  write_file(capture / "scene.json", R"({"alpha": "green"})");
  CHECK_THAT(
      bad_reference([&] { capture.load(); }), Contains("alpha is 'green'") && Contains("expected")
  );
}

TEST_CASE("colours that are multiplied by their alpha already are told from straight ones") {
  AlphaCapture capture;
  const auto is_told = [&](const std::function<Rgba(int, int)>& pixel) {
    write_file(capture / "images/0003.png", rgba_png(48, 36, pixel));
    return capture.load().data_notes.at(0).find("brighter than its alpha") != std::string::npos;
  };
  CHECK_FALSE(is_told(pane));
  CHECK(is_told([](int x, int y) {
    Rgba color = pane(x, y);
    for (int c = 0; c < 3; ++c)
      color[static_cast<std::size_t>(c)] =
          static_cast<std::uint8_t>(color[static_cast<std::size_t>(c)] * color[3] / 255);
    return color;
  }));
  // A mask without half tones says nothing.
  CHECK_FALSE(is_told([](int x, int) { return x < 9 ? Rgba{9, 9, 9, 255} : Rgba{0, 0, 0, 0}; }));
}

TEST_CASE("pictures of Blender's transforms lie on white") {
  AlphaCapture capture;
  fs::rename(capture / "transforms.json", capture / "transforms_train.json");
  const Scene scene = capture.load();
  REQUIRE(scene.dataset == "blender");
  CHECK(scene.train.at(2).rgb.at(5, 30, 1) == 1);
  CHECK_THAT(scene.data_notes.at(0), Contains("laid on white"));
}

namespace {

// As Windows' Notepad and PowerShell leave text.
std::string with_mark(const std::string& text) { return "\xef\xbb\xbf" + text; }
std::string as_utf16(const std::string& text) {
  std::string wide = "\xff\xfe";
  for (const char c : text) wide += {c, '\0'};
  return wide;
}

}  // namespace

TEST_CASE("text with a mark of UTF-8 and Windows' line ends is read, UTF-16 is refused by its name"
) {
  Capture capture;
  const std::string json = capture.json.dump();
  write_file(capture / "transforms.json", with_mark(json));
  CHECK(capture.load().train.size() + capture.load().test.size() == 10);
  write_file(capture / "transforms.json", as_utf16(json));
  CHECK_THAT(
      bad_reference([&] { capture.load(); }),
      Contains("transforms.json: text in UTF-16") && Contains("save it as UTF-8")
  );
  const TempFolder colmap;
  for (int i = 0; i < 3; ++i)
    write_png(
        colmap / fmt::format("images/{}.png", i), Image(12, 8, 3, 0.3f * static_cast<float>(i))
    );
  write_file(
      colmap / "sparse/0/images.txt",
      with_mark("1 1 0 0 0 0 0 0 1 0.png\r\n\r\n2 1 0 0 0 1 0 0 1 1.png\r\n\r\n3 1 0 0 0 2 0 0 1 "
                "2.png\r\n\r\n")
  );
  write_file(colmap / "sparse/0/cameras.txt", with_mark("1 PINHOLE 12 8 10 10 6 4\r\n"));
  write_file(colmap / "sparse/0/points3D.txt", with_mark("1 0 0 5 128 128 128 0\r\n"));
  write_file(colmap / "sparse/0/test.txt", with_mark("1.png\r\n"));
  const Scene scene = load_scene(colmap.path(), {});
  REQUIRE(scene.test.size() == 1);
  CHECK(scene.test[0].name == "1");
  write_file(colmap / "sparse/0/test.txt", as_utf16("1.png\r\n"));
  CHECK_THAT(
      bad_reference([&] { load_scene(colmap.path(), {}); }), Contains("test.txt: text in UTF-16")
  );
}

TEST_CASE(
    "a picture whose name differs in case or in how marks are written is found, if one alone does"
) {
  Capture capture;
  const auto rename = [&](const char* from, const std::string& to) {
    fs::rename(capture / (std::string("images/") + from), capture / ("images/" + to));
  };
  rename("0001.png", "0001.PNG");
  rename("0002.png", "cafe\xcc\x81.png");  // e, then a mark: macOS
  for (Json& frame : capture.json["frames"])
    if (frame["file_path"].get<std::string>().ends_with("0002.png"))
      frame["file_path"] = "images/caf\xc3\xa9.png";
  capture.store();
  CHECK(capture.load().train.size() + capture.load().test.size() == 10);
  fs::copy_file(capture / "images/0001.PNG", capture / "images/0001.Png");
  CHECK_THAT(bad_reference([&] { capture.load(); }), Contains("0001.png"));
}

TEST_CASE("what phones, cameras and Python write is refused with what to do") {
  Capture capture;
  fs::rename(capture / "images/0001.png", capture / "images/0001.heic");
  for (Json& frame : capture.json["frames"])
    if (frame["file_path"].get<std::string>().ends_with("0001.png"))
      frame["file_path"] = "images/0001.heic";
  capture.store();
  CHECK_THAT(
      bad_reference([&] { capture.load(); }), Contains("0001.heic") && Contains("heif-convert")
  );
  std::string text = capture.json.dump();
  const std::size_t matrix = text.find("[[");
  text.replace(matrix + 2, text.find(',', matrix) - matrix - 2, "NaN");
  write_file(capture / "transforms.json", text);
  CHECK_THAT(bad_reference([&] { capture.load(); }), Contains("NaN and Infinity"));
}

TEST_CASE("the model of ns-process-data is found where transforms.json is not beside it") {
  const TempFolder folder;
  for (int i = 0; i < 2; ++i)
    write_png(
        folder / fmt::format("images/{}.png", i), Image(12, 8, 3, 0.4f * static_cast<float>(i))
    );
  const fs::path model = folder / "colmap/sparse/0";
  write_file(model / "images.txt", "1 1 0 0 0 0 0 0 1 0.png\n\n2 1 0 0 0 1 0 0 1 1.png\n\n");
  write_file(model / "cameras.txt", "1 PINHOLE 12 8 10 10 6 4\n");
  write_file(model / "points3D.txt", "1 0 0 5 128 128 128 0\n");
  CHECK(load_scene(folder.path(), {}).train.size() == 1);
}
