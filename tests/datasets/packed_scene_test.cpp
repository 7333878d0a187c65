// SPDX-License-Identifier: MIT
#include "datasets/packed_scene.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "datasets/view_maps.h"
#include "glint/core/config.h"
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

// As files of version 1 were written, before maps were coded.
class FirstVersion {
 public:
  explicit FirstVersion(const Scene& scene) {
    for (const auto& [name, views] : {std::pair{"train", &scene.train}, {"test", &scene.test}})
      add_views(name, *views);
    const auto count = scene.points.positions.size();
    add_vectors("points.positions", scene.points.positions);
    add_vectors("points.colors", scene.points.colors);
    REQUIRE((scene.points.normals.empty() && count > 0));
    add_vectors("bounds", {scene.bounds_min, scene.bounds_max});
    add<float>("spatial_scale", {1}, {scene.spatial_scale});
  }
  std::vector<TensorToWrite> tensors;

 private:
  template <class T>
  void add(const std::string& name, std::vector<std::size_t> shape, std::vector<T> values) {
    tensors.push_back({name, {kTensorTypeOf<T>, std::move(shape)}, [values](std::byte* to) {
                         std::memcpy(to, values.data(), values.size() * sizeof(T));
                       }});
  }
  void add_vectors(const std::string& name, const std::vector<Vec3f>& vectors) {
    std::vector<float> values;
    for (const Vec3f v : vectors) values.insert(values.end(), {v.x, v.y, v.z});
    add(name, {vectors.size(), 3}, values);
  }
  void add_views(const std::string& split, const std::vector<View>& views) {
    std::vector<std::int32_t> sizes;
    std::vector<double> intrinsics, poses;
    for (std::size_t i = 0; i < views.size(); ++i) {
      const Camera& c = views[i].camera;
      sizes.insert(sizes.end(), {c.width, c.height});
      intrinsics.insert(intrinsics.end(), {c.fx, c.fy, c.cx, c.cy});
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3d& row = c.rotation_cam_from_world.rows[axis];
        poses.insert(poses.end(), {row.x, row.y, row.z, c.translation_cam_from_world[axis]});
      }
      for_each_map(views[i], [&](const std::string& name, const Image& map, const MapRow&) {
        if (!map.empty()) add_map(split + "." + std::to_string(i) + "." + name, map);
      });
    }
    add(split + ".size", {views.size(), 2}, sizes);
    add(split + ".intrinsics", {views.size(), 4}, intrinsics);
    add(split + ".cam_from_world", {views.size(), 3, 4}, poses);
  }
  void add_map(const std::string& name, const Image& map) {
    const std::vector<std::size_t> shape{
        std::size_t(map.height()), std::size_t(map.width()), std::size_t(map.channels())};
    std::vector<std::uint8_t> bytes;
    for (const float value : map.values()) bytes.push_back(std::uint8_t(value * 255 + 0.5f));
    const bool fits = std::equal(
        bytes.begin(),
        bytes.end(),
        map.values().begin(),
        [](std::uint8_t byte, float value) { return float(byte) / 255 == value; }
    );
    if (fits)
      add(name, shape, bytes);
    else
      add(name, shape, std::vector<float>(map.values().begin(), map.values().end()));
  }
};

void write_first_version(const fs::path& file, const Scene& scene) {
  const auto names = [](const std::vector<View>& views) {
    Json list = Json::array();
    for (const View& view : views) list.push_back(view.name);
    return list.dump();
  };
  write_safetensors(
      file,
      {{"format", "glint-scene"},
       {"version", "1"},
       {"name", scene.name},
       {"dataset", scene.dataset},
       {"hash", scene.spec_hash},
       {"simulated_priors", scene.simulated_priors ? "true" : "false"},
       {"train_views", names(scene.train)},
       {"test_views", names(scene.test)}},
      FirstVersion(scene).tensors
  );
}

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

TEST_CASE("a file of the first version, in which every map is a tensor of numbers, is read") {
  const TempFolder folder;
  const Scene scene = box_scene();
  write_first_version(folder / "old", scene);
  check_same(read_packed_scene(folder / "old"), scene);
  CHECK(is_packed_scene(folder / "old"));
}

TEST_CASE("views that lack maps, and views of other sizes, share a file") {
  const TempFolder folder;
  Scene scene = box_scene();
  const std::vector<View> views = box_room_views(12, {8, 6}), small = box_room_views(12, {5, 7});
  scene.train = views;
  scene.test.clear();
  for (std::size_t i = 0; i < views.size(); i += 3) scene.train[i] = small[i];
  for (std::size_t i = 0; i < views.size(); i += 2) scene.train[i].truth = {};
  for (std::size_t i = 0; i < 8; ++i) scene.train[i].priors = {};
  write_packed_scene(folder / "x", scene);
  check_same(read_packed_scene(folder / "x"), scene);
}

TEST_CASE("a compact scene trains and scores as before with what is left") {
  Scene scene = small_room();
  const Scene whole = scene;
  make_compact(scene);
  for (std::size_t i = 0; i < scene.train.size(); ++i) {
    CHECK(same_bytes(scene.train[i].rgb, whole.train[i].rgb));
    CHECK(same_bytes(scene.train[i].priors["normal"], whole.train[i].priors["normal"]));
    CHECK(same_bytes(scene.train[i].truth["glass"], whole.train[i].truth["glass"]));
    CHECK_FALSE(scene.train[i].truth.has("depth"));
  }
  const MapSet &truth = scene.test.at(0).truth, &before = whole.test.at(0).truth;
  CHECK(scene.test[0].priors.empty());
  CHECK(same_bytes(truth["normal"], before["normal"]));
  CHECK_FALSE(truth.has("albedo"));
  REQUIRE(before.has("behind_depth"));
  const Image &glass = truth["glass"], &behind = truth["behind_depth"];
  for (std::size_t i = 0; i < glass.num_pixels(); ++i)
    CHECK(
        behind.data()[i] ==
        Approx(glass.data()[i] != 0 ? before["behind_depth"].data()[i] : 0).margin(0.07e-3)
    );
  const TempFolder folder;
  write_packed_scene(folder / "x", scene);
  check_same(read_packed_scene(folder / "x"), scene);
  write_packed_scene(folder / "whole", whole);
  CHECK(fs::file_size(folder / "x") < fs::file_size(folder / "whole") / 2);
}

TEST_CASE("a compact scene keeps all parts of what is seen at panes, also those no method renders"
) {
  Scene scene = small_room();
  MapSet& truth = scene.test.at(0).truth;
  const Image glass = truth["glass"];
  for (const MapId id : {MapId("path_t"), MapId("path_rest")})
    truth[id] = Image(glass.width(), glass.height(), 3, 0.5f);
  make_compact(scene);
  for (const MapId id : {MapId("path_t"), MapId("path_rest")})
    for (std::size_t i = 0; i < glass.num_pixels(); ++i)
      CHECK(truth[id].data()[3 * i] == (glass.data()[i] != 0 ? 0.5f : 0.0f));
}

TEST_CASE("priors are left out by name") {
  Scene scene = small_room();
  leave_out_prior("basecolor", scene);
  CHECK_FALSE(scene.train[0].priors.has("basecolor"));
  CHECK(scene.train[0].priors.has("albedo"));
  CHECK_THROWS_WITH(leave_out_prior("basecolor", scene), Contains("no such prior; priors are"));
  CHECK_THROWS_WITH(leave_out_prior("colour", scene), Contains("--without colour"));
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
  CHECK_THAT(error([](Json& h) { h["__metadata__"]["version"] = "3"; }), Contains("version 3"));
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
      error([&](Json& h) { rename(h, "train.rgb.0", "train.rbg.0"); }),
      Contains("train.rbg.0 has no place")
  );
  CHECK_THAT(
      error([&](Json& h) { rename(h, "train.intrinsics", "intrinsics"); }),
      Contains("no tensor train.intrinsics")
  );
  CHECK_THAT(
      error([&](Json& h) { rename(h, "train.truth.depth.0", "train.truth.depth.1"); }),
      Contains("train.truth.depth.1 has no place")
  );
  CHECK_THAT(
      error([&](Json& h) { std::swap(h["train.truth.depth.0"], h["train.rgb.0"]); }),
      Contains("train.rgb.0: ")
  );
  CHECK_THAT(
      error([](Json& h) { h["train.truth.depth.0"]["dtype"] = "I32"; }),
      Contains("train.truth.depth.0: shape")
  );
}

TEST_CASE("maps of views that are not there, and too few bytes for the pixels, are errors") {
  const PackedFile f;
  const auto error = [&](const char* tensor, std::size_t at, char byte) {
    std::string text = read_file(f.file);
    const Json offsets = f.header()[tensor]["data_offsets"];
    text[8 + PackedFile::length(text) + offsets[0].get<std::size_t>() + at] = byte;
    write_file(f / "changed", text);
    return bad_reference([&] { read_packed_scene(f / "changed"); });
  };
  CHECK_THAT(error("train.rgb.0", 0, 0), Contains("train.rgb.0: it names maps of views"));
  CHECK_THAT(
      error("train.rgb.0", 0, 7), Contains("it names maps of views that are not there (0x7)")
  );
  CHECK_THAT(error("train.rgb.0", 1, 99), Contains("code 99 is not known"));
  CHECK_THAT(error("points.positions", 5, 1), Contains("bytes for 1099511627778 points"));
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
