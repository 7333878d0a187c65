// SPDX-License-Identifier: MIT
#include "datasets/packed_scene.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "glint/core/config.h"
#include "glint/core/rng.h"
#include "glint/scene/safetensors.h"
#include "tests/support/box_room.h"
#include "tests/support/same_scene.h"
#include "tests/support/small_room.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

Scene box_scene() {
  Scene scene;
  scene.name = "box \"1\"";
  scene.dataset = "made";
  scene.spec_hash = "abc";
  scene.train = box_room_views(3, {8, 6});
  scene.test = {scene.train.back()};
  scene.train.pop_back();
  scene.points.positions = {{0.1f, -0.0f, 3}, {1, 2, 1e-30f}};
  scene.points.colors = {{0, 1, 0.5f}, {0.25f, 0, 1}};
  set_extent(scene);
  return scene;
}

// A packed scene whose header a test changes.
struct PackedFile : TempFolder {
  fs::path file = path() / "room.safetensors";
  PackedFile() { write_packed_scene(file, box_scene()); }

  Json header() const {
    const std::string text = read_file(file);
    return Json::parse(text.substr(8, length(text)));
  }
  // The error of the file with another header, which must not be longer.
  std::string error_with(const Json& changed) const {
    std::string text = read_file(file);
    std::string header = changed.dump();
    REQUIRE(header.size() <= length(text));
    header.resize(length(text), ' ');
    text.replace(8, header.size(), header);
    write_file(path() / "changed", text);
    return bad_reference([&] { read_packed_scene(path() / "changed"); });
  }
  static std::uint64_t length(const std::string& text) {
    std::uint64_t length = 0;
    std::memcpy(&length, text.data(), sizeof length);
    return length;
  }
};

std::string write_error(Scene scene, const std::function<void(Scene&)>& spoil) {
  const TempFolder folder;
  spoil(scene);
  const std::string message = bad_reference([&] { write_packed_scene(folder / "x", scene); });
  CHECK_FALSE(fs::exists(folder / "x"));
  return message;
}

}  // namespace

TEST_CASE("a packed scene is the folder's scene, bit for bit") {
  const TempFolder folder;
  const fs::path file = folder / "room.safetensors";
  write_packed_scene(file, small_room());
  const Scene packed = load_scene(file, {});
  check_same(packed, small_room());
  CHECK(find_loader(file).name == "packed");
  CHECK(check_dataset(file).empty());
  CHECK_FALSE(packed.train[0].truth["glass"].empty());
  CHECK_FALSE(packed.train[0].truth["transmitted"].empty());
  CHECK_FALSE(packed.train[0].priors["normal"].empty());
}

TEST_CASE("scenes made by hand survive, with points without normals and odd names") {
  const TempFolder folder;
  Scene scene = box_scene();
  scene.train[0].name = "a/b \u00e9 \\";
  scene.train[1].truth = {};
  write_packed_scene(folder / "x", scene);
  check_same(read_packed_scene(folder / "x"), scene);
  scene.test.clear();
  scene.points = {};
  write_packed_scene(folder / "x", scene);
  check_same(read_packed_scene(folder / "x"), scene);
  REQUIRE(check_dataset(folder / "x").size() == 1);
  CHECK(check_dataset(folder / "x")[0].check == "no-test-views");
}

TEST_CASE("without the truth of train views all is there that a method trains on") {
  Scene scene = small_room(), whole = scene;
  REQUIRE(scene.train.at(0).truth.has("glass"));
  REQUIRE(scene.train.at(0).truth.has("depth"));
  leave_out_train_truth(scene);
  for (std::size_t i = 0; i < scene.train.size(); ++i) {
    CHECK(same_bytes(scene.train[i].truth["glass"], whole.train[i].truth["glass"]));
    CHECK(!scene.train[i].truth.has("depth"));
    whole.train[i].truth = scene.train[i].truth;
  }
  check_same(scene, whole);
}

TEST_CASE("packing twice gives the same bytes") {
  const TempFolder folder;
  write_packed_scene(folder / "a", box_scene());
  write_packed_scene(folder / "b", box_scene());
  CHECK(read_file(folder / "a") == read_file(folder / "b"));
}

TEST_CASE("maps take 8 or 16 bits only where that gives back the very floats") {
  const TempFolder folder;
  Scene scene = box_scene();
  Image& rgb = scene.train[0].rgb;
  const auto fill = [&](float last, float step) {
    for (float& value : rgb.values()) value = step;
    rgb.data()[3] = last;
  };
  const auto stored = [&] {
    write_packed_scene(folder / "x", scene);
    check_same(read_packed_scene(folder / "x"), scene);
    return SafetensorsFile(folder / "x").find("train.0.rgb")->type;
  };
  fill(200 / 255.0f, 1);
  CHECK(stored() == TensorType::kU8);
  fill(1234 / 65535.0f, 0);
  CHECK(stored() == TensorType::kU16);
  fill(std::nextafter(200 / 255.0f, 1.0f), 1);
  CHECK(stored() == TensorType::kF32);
  fill(-0.0f, 0);
  CHECK(stored() == TensorType::kF32);
  fill(1.5f, 0);
  CHECK(stored() == TensorType::kF32);
}

TEST_CASE("options drop priors and truth and resize, as with folders") {
  const TempFolder folder;
  write_packed_scene(folder / "x", box_scene());
  LoadOptions options;
  options.with_priors = false;
  options.with_truth = false;
  options.size = {4, 3};
  const Scene scene = load_scene(folder / "x", options);
  CHECK(scene.train[0].priors["normal"].empty());
  CHECK(scene.train[0].truth["depth"].empty());
  CHECK(scene.train[0].rgb.size() == ImageSize{4, 3});
  CHECK(scene.test[0].camera.width == 4);
}

TEST_CASE("options of priors are refused: a packed scene has the priors that it was packed with") {
  const TempFolder folder;
  write_packed_scene(folder / "x", box_scene());
  LoadOptions options;
  options.priors.axes = "opengl";
  try {
    load_scene(folder / "x", options);
    FAIL("took them");
  } catch (const Error& error) {
    CHECK(error.code() == ExitCode::kUsage);
    CHECK_THAT(error.what(), Contains("dataset pack"));
  }
}

TEST_CASE("a header that is not a scene's is an error that names the tensor") {
  const PackedFile f;
  const auto error = [&](const std::function<void(Json&)>& change) {
    Json header = f.header();
    change(header);
    return f.error_with(header);
  };
  const auto rename = [](Json& header, const char* from, const char* to) {
    header[to] = header[from];
    header.erase(from);
  };
  CHECK_THAT(error([](Json& h) { h["__metadata__"]["version"] = "2"; }), Contains("version 2"));
  CHECK_THAT(error([](Json& h) { h["__metadata__"]["format"] = "pt"; }), Contains("pt of version"));
  CHECK_THAT(error([](Json& h) { h["__metadata__"].erase("hash"); }), Contains("has no hash"));
  CHECK_THAT(
      error([](Json& h) { h["__metadata__"]["train_views"] = "[1]"; }),
      Contains("train_views is no list")
  );
  CHECK_THAT(
      error([](Json& h) { h["__metadata__"]["train_views"] = "[]"; }),
      Contains("train.size is I32 (2, 2), expected I32 (0, 2)")
  );
  CHECK_THAT(
      error([&](Json& h) { rename(h, "train.0.rgb", "train.0.rbg"); }),
      Contains("train.0.rbg has no place")
  );
  CHECK_THAT(
      error([&](Json& h) { rename(h, "train.intrinsics", "intrinsics"); }),
      Contains("no tensor train.intrinsics")
  );
  CHECK_THAT(
      error([](Json& h) {
        h["train.1.truth.depth"]["shape"] = {8, 6, 1};
      }),
      Contains("train.1.truth.depth is F32 (8, 6, 1), expected F32 (6, 8, 1)")
  );
  CHECK_THAT(
      error([](Json& h) { h["train.1.truth.depth"]["dtype"] = "I32"; }),
      Contains("is I32 (6, 8, 1), expected F32")
  );
}

TEST_CASE("a file that was cut off is an error wherever it was") {
  const PackedFile f;
  const std::string text = read_file(f.file);
  for (std::size_t length = 0; length < text.size(); length += 61) {
    write_file(f / "cut", text.substr(0, length));
    CHECK_THAT(bad_reference([&] { read_packed_scene(f / "cut"); }), Contains("cut: "));
  }
}

TEST_CASE("values that are no scene's are errors, when packed and when read") {
  const Scene good = box_scene();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK_THAT(
      write_error(good, [&](Scene& s) { s.train[1].truth["depth"].data()[5] = nan; }),
      Contains("train.1.truth.depth: value 5 is nan")
  );
  CHECK_THAT(
      write_error(good, [&](Scene& s) { s.points.positions[1].y = nan; }),
      Contains("points.positions: value 4 is nan")
  );
  CHECK_THAT(
      write_error(good, [](Scene& s) { s.points.colors.pop_back(); }),
      Contains("points.colors: 1 rows, expected 2")
  );
  CHECK_THAT(write_error(good, [](Scene& s) { s.train.clear(); }), Contains("no train views"));
  CHECK_THAT(write_error(good, [](Scene& s) { s.spatial_scale = 0; }), Contains("spatial_scale"));
  CHECK_THAT(
      write_error(good, [](Scene& s) { s.test[0].camera.fx = -1; }),
      Contains("test.0.camera: focal")
  );
  CHECK_THAT(
      write_error(good, [](Scene& s) { s.test[0].truth["glass"] = Image(3, 3, 1); }),
      Contains("test.0.truth.glass: (3, 3, 1), expected (6, 8, 1)")
  );
  CHECK_THAT(
      write_error(good, [](Scene& s) { s.train[0].camera.width = 70000; }), Contains("70000 x 6")
  );
}

TEST_CASE("a damaged file is read or is an error, and nothing else") {
  const PackedFile f;
  const std::string good = read_file(f.file);
  Rng rng(5);
  const auto random = [&](std::size_t below) {
    return rng.below(static_cast<std::uint32_t>(below));
  };
  for (int round = 0; round < 300; ++round) {
    std::string text = good;
    const std::size_t range = round % 2 == 0 ? 8 + PackedFile::length(good) : good.size();
    for (int i = 0; i < 3; ++i) text[random(range)] = static_cast<char>(random(256));
    write_file(f / "bad", text);
    try {
      read_packed_scene(f / "bad");
    } catch (const Error& error) {
      CHECK(error.code() == ExitCode::kBadReference);
    }
  }
}

TEST_CASE("names of a packed scene that would lead out of the results or share a folder are refused"
) {
  const TempFolder folder;
  const auto error_of_scene = [&](const std::function<void(Scene&)>& change) {
    Scene scene = box_scene();
    change(scene);
    return bad_reference([&] { write_packed_scene(folder / "x.safetensors", scene); });
  };
  for (const char* name : {"/etc", "..", "../x", "", "a\x1b[2Jb"})
    CHECK_THAT(error_of_scene([&](Scene& s) { s.name = name; }), Contains("__metadata__: name: '"));
  const std::string same = error_of_scene([](Scene& s) { s.train[1].name = s.train[0].name; });
  CHECK_THAT(same, Contains("is used twice"));
  const std::string shared =
      error_of_scene([](Scene& s) { s.train[0].name = "a/b", s.test[0].name = "a_b"; });
  CHECK_THAT(shared, Contains("a/b and a_b") && Contains("share the folder a_b"));
  for (const char* name : {"..", "", "x\n"})
    CHECK_THAT(
        error_of_scene([&](Scene& s) { s.test[0].name = name; }), Contains("rename the view")
    );
  // The same in a file that someone else wrote.
  const PackedFile file;
  Json header = file.header();
  header["__metadata__"]["name"] = "../b";
  CHECK_THAT(file.error_with(header), Contains("name: '../b' holds a path separator"));
}
