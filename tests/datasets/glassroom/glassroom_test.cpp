// SPDX-License-Identifier: MIT
#include "datasets/glassroom/glassroom.h"

#include <unistd.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <set>

#include "datasets/dataset.h"
#include "datasets/glassroom/write_scene.h"
#include "glint/core/error.h"
#include "glint/core/progress.h"
#include "glint/scene/image_files.h"
#include "glint/scene/ply.h"

using namespace glint;

namespace {

const GlassRoomOptions kTiny{.scene = "room_2", .width = 32, .height = 18, .views = 8, .spp = 2};

struct QuietFolder : TemporaryFolder {
  QuietFolder() : TemporaryFolder("glassroom_test") { set_quiet(true); }
};

std::size_t num_entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

}  // namespace

TEST_CASE("The same options give the same bytes, and a finished scene is not made again") {
  const QuietFolder temporary;
  const fs::path a = temporary.path() / "a", b = temporary.path() / "b";
  REQUIRE(make_glassroom(kTiny, a, false));
  REQUIRE(make_glassroom(kTiny, b, false));
  CHECK(file_hashes(a) == file_hashes(b));
  const auto written = fs::last_write_time(a / "scene.json");
  CHECK_FALSE(make_glassroom(kTiny, a, false));
  CHECK(fs::last_write_time(a / "scene.json") == written);
  CHECK(num_entries(temporary.path()) == 2);  // nothing temporary is left
  fs::remove(a / "gt" / "mesh_behind.ply");   // as earlier releases left it
  CHECK_FALSE(make_glassroom(kTiny, a, false));
  CHECK(file_hashes(a) == file_hashes(b));

  GlassRoomOptions other = kTiny;
  other.seed = 1;
  CHECK(make_glassroom(other, a, false));
  CHECK(file_hashes(a) != file_hashes(b));
  CHECK(num_entries(temporary.path()) == 2);
}

TEST_CASE("A scene folder loads, and its maps agree with each other") {
  const QuietFolder temporary;
  const fs::path folder = temporary.path() / "room_2";
  make_glassroom(kTiny, folder, false);
  const Scene scene = load_scene(folder, {});
  CHECK(scene.simulated_priors);
  CHECK(scene.dataset == "glassroom");
  CHECK(scene.train.size() == 7);
  CHECK(scene.test.size() == 1);
  CHECK(scene.points.positions.size() > 1000);
  CHECK(check_dataset(folder).empty());
  const View& view = scene.train.front();
  const Image rgb = read_image(folder / "gt" / "rgb" / (view.name + ".exr"), 3);
  for (int y = 0; y < rgb.height(); ++y)
    for (int x = 0; x < rgb.width(); ++x)
      for (int c = 0; c < 3; ++c) {
        const float shown = std::clamp(srgb_encode(rgb.at(x, y, c)), 0.0f, 1.0f);
        REQUIRE(view.rgb.at(x, y, c) == Approx(shown).margin(0.51 / 255));
        if (view.truth["glass"].at(x, y) == 0) continue;
        const float sum =
            view.truth["transmitted"].at(x, y, c) + view.truth["reflected"].at(x, y, c);
        REQUIRE(sum == Approx(rgb.at(x, y, c)).epsilon(1e-4).margin(1e-6));
      }
}

TEST_CASE("OpenCV reads the camera files, and both rotations are the same") {
  const QuietFolder temporary;
  const Camera camera = look_at({1.2, -2, 1.5}, {0.1, 0.2, 0.6}, {0, 0, 1}, {64, 36}, 80);
  write_cameras(temporary.path(), {camera, camera});
  cv::FileStorage intri((temporary.path() / "intri.yml").string(), cv::FileStorage::READ);
  cv::FileStorage extri((temporary.path() / "extri.yml").string(), cv::FileStorage::READ);
  std::vector<std::string> names;
  intri["names"] >> names;
  CHECK(names == std::vector<std::string>{"0000", "0001"});
  cv::Mat k, rotation, rodrigues, translation;
  intri["K_0001"] >> k;
  CHECK(k.at<double>(0, 0) == camera.fx);
  CHECK(k.at<double>(1, 2) == 18);
  CHECK(static_cast<int>(intri["W_0001"]) == 64);
  extri["Rot_0001"] >> rotation;
  extri["R_0001"] >> rodrigues;
  extri["T_0001"] >> translation;
  const Vec3d axis{rodrigues.at<double>(0), rodrigues.at<double>(1), rodrigues.at<double>(2)};
  const double angle = length(axis);
  const Vec3d v{0.3, -0.4, 0.7}, unit = (1 / angle) * axis;
  // Rodrigues' rotation formula.
  const Vec3d turned = std::cos(angle) * v + std::sin(angle) * cross(unit, v) +
                       (1 - std::cos(angle)) * dot(unit, v) * unit;
  const Vec3d expected = camera.rotation_cam_from_world * v;
  for (int i = 0; i < 3; ++i) {
    CHECK(turned[i] == Approx(expected[i]).margin(1e-12));
    CHECK(rotation.at<double>(i, 2) == camera.rotation_cam_from_world.rows[i].z);
    CHECK(translation.at<double>(i) == camera.translation_cam_from_world[i]);
  }
}

TEST_CASE("The ground-truth mesh has short edges and the scene's area") {
  TraceScene scene;
  scene.materials.push_back({.name = "white"});
  TraceMesh quad{
      .name = "quad",
      .vertices = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}},
      .faces = {{0, 1, 2}, {0, 2, 3}}};
  scene.meshes.push_back(quad);
  const TriangleMesh mesh = truth_mesh(scene, TruthLayer::kFirst, 0.25f);
  double area = 0;
  std::set<std::pair<int, int>> once;  // directed edges: a conforming mesh has each at most once
  for (const auto& f : mesh.faces) {
    const auto p = [&](int k) {
      return mesh.vertices[static_cast<std::size_t>(f[static_cast<std::size_t>(k)])];
    };
    area += 0.5 * static_cast<double>(length(cross(p(1) - p(0), p(2) - p(0))));
    for (int k = 0; k < 3; ++k) {
      CHECK(length(p(k) - p((k + 1) % 3)) <= 0.2501f);
      CHECK(once.insert({f[static_cast<std::size_t>(k)], f[static_cast<std::size_t>((k + 1) % 3)]})
                .second);
    }
  }
  CHECK(area == Approx(2));
}

TEST_CASE("The ground-truth mesh behind glass lacks the panes and nothing else") {
  TraceScene scene;
  scene.materials.push_back({.name = "white"});
  scene.materials.push_back({.name = "glass", .kind = MaterialKind::kThinDielectric});
  const TraceMesh wall{
      .name = "wall", .vertices = {{0, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}}, .faces = {{0, 1, 2}}};
  TraceMesh pane = wall;
  pane.name = "pane";
  pane.vertices = {{0, 0, 1}, {0.1f, 0, 1}, {0, 0.1f, 1}};
  pane.material = 1;
  scene.meshes = {wall, pane};
  CHECK(truth_mesh(scene, TruthLayer::kFirst, 1).faces.size() == 2);
  const TriangleMesh behind = truth_mesh(scene, TruthLayer::kBehind, 1);
  REQUIRE(behind.faces.size() == 1);
  for (const Vec3f& vertex : behind.vertices) CHECK(vertex.z == 0);
}

TEST_CASE("An error leaves no folder behind, and foreign folders are not touched") {
  const QuietFolder temporary;
  GlassRoomOptions bad = kTiny;
  bad.scene = "room_7";
  CHECK_THROWS_AS(make_glassroom(bad, temporary.path() / "x", false), Error);
  CHECK(num_entries(temporary.path()) == 0);

  const fs::path foreign = temporary.path() / "holiday";
  write_file(foreign / "photo.txt", "mine");
  CHECK_THROWS_WITH(
      make_glassroom(kTiny, foreign, false), Catch::Contains("not a GlassRoom scene")
  );
  CHECK(read_file(foreign / "photo.txt") == "mine");
}

TEST_CASE("The cache key follows the options") {
  GlassRoomOptions options = kTiny;
  const std::string plain = glassroom_hash(options);
  options.spp = 3;
  CHECK(glassroom_hash(options) != plain);
  options.spp = kTiny.spp;
  CHECK(glassroom_hash(options) == plain);
  options.assets = "furniture";  // of earlier versions
  CHECK_THROWS_WITH(glassroom_hash(options), Catch::Contains("assets is 'furniture'"));
}

TEST_CASE("Priors count in the cache key, but for those that there have always been") {
  GlassRoomOptions options = kTiny;
  CHECK(glassroom_hash(options) == "816623b7038bb6f4");  // from before there was the option
  CHECK_FALSE(glassroom_json(options).contains("priors"));
  options.priors = "poor";
  CHECK(glassroom_hash(options) != "816623b7038bb6f4");
  CHECK(glassroom_json(options).at("priors") == "poor");
}

TEST_CASE("Layers count in the cache key where they are not there by themselves") {
  GlassRoomOptions options = kTiny;
  const std::string plain = glassroom_hash(options);
  options.layers = true;
  CHECK(glassroom_hash(options) != plain);
  CHECK(glassroom_json(options).at("layers") == true);
  options.scene = "nested_1";
  CHECK_FALSE(glassroom_json(options).contains("layers"));
}

TEST_CASE("A room with layers is the same room and has their maps besides") {
  const QuietFolder temporary;
  const fs::path usual = temporary.path() / "usual", layered = temporary.path() / "layered";
  GlassRoomOptions options = kTiny;
  make_glassroom(options, usual, false);
  options.layers = true;
  make_glassroom(options, layered, false);
  CHECK(check_dataset(layered).empty());
  const Json before = file_hashes(usual), after = file_hashes(layered);
  for (const auto& [name, hash] : before.items())
    if (name != "scene.json" && name != "contact_sheet.png") CHECK(after.at(name) == hash);
  for (const char* name : {"layer_1_mirror/0000.png", "layer_4_depth/0007.exr", "path_tr/0003.exr"})
    CHECK(after.contains(std::string("gt/") + name));
  CHECK_FALSE(before.contains("gt/layer_1_mirror/0000.png"));
  const Json json = Json::parse(read_file(layered / "scene.json"));
  CHECK(json["layers"] == true);
  CHECK(json["panes_and_mirrors"].size() == 6);
  CHECK(json["noise_floor"]["views"] == 1);
  CHECK(json["noise_floor"]["path_tt"]["standard_error"].get<float>() > 0);
  CHECK_FALSE(Json::parse(read_file(usual / "scene.json")).contains("noise_floor"));
}

TEST_CASE("A scene beyond first order is made alike twice, and loads with its layers") {
  const QuietFolder temporary;
  const fs::path a = temporary.path() / "a", b = temporary.path() / "b";
  GlassRoomOptions options = kTiny;
  options.scene = "mirror_1";
  make_glassroom(options, a, false);
  make_glassroom(options, b, false);
  CHECK(file_hashes(a) == file_hashes(b));
  CHECK(check_dataset(a).empty());
  const Scene scene = load_scene(a, {});
  double mirrors = 0;
  for (const View& view : scene.train) {
    CHECK(view.truth.has("layer_4_normal"));
    for (const float value : view.truth["layer_1_mirror"].values())
      mirrors += static_cast<double>(value);
  }
  CHECK(mirrors > 100);
}

TEST_CASE("A room with worse priors is the same room, and loads without those that are missing") {
  const QuietFolder temporary;
  const fs::path usual = temporary.path() / "usual", bad = temporary.path() / "bad";
  GlassRoomOptions options = kTiny;
  make_glassroom(options, usual, false);
  options.priors = "bad";
  make_glassroom(options, bad, false);
  const Json json = Json::parse(read_file(bad / "scene.json"));
  CHECK(json["simulated_priors"] == true);
  CHECK(json["prior_level"] == "bad");
  CHECK(json["prior_model"]["missing_rate"].get<float>() == 0.3f);
  REQUIRE(json["without_priors"].size() == 2);  // of seven training views, and of one test view
  CHECK(check_dataset(bad).empty());
  const Scene scene = load_scene(bad, {}), as_ever = load_scene(usual, {});
  std::size_t missing = 0;
  for (std::size_t i = 0; i < scene.train.size(); ++i) {
    const View &view = scene.train[i], &same = as_ever.train[i];
    CHECK(std::ranges::equal(view.rgb.values(), same.rgb.values()));
    CHECK(std::ranges::equal(view.truth["depth"].values(), same.truth["depth"].values()));
    CHECK_FALSE(same.priors.empty());
    missing += view.priors.empty();
    for (const MapId id : {MapId("normal"), MapId("depth"), MapId("albedo"), MapId("basecolor")})
      CHECK(view.priors.has(id) == !view.priors.empty());
  }
  CHECK(missing == 2);
}

TEST_CASE("A level of priors that there is not is an error of the option") {
  const QuietFolder temporary;
  GlassRoomOptions options = kTiny;
  options.priors = "worst";
  try {
    make_glassroom(options, temporary.path() / "x", false);
    FAIL("made a room with such priors");
  } catch (const Error& error) {
    CHECK(error.code() == ExitCode::kUsage);
    CHECK_THAT(error.what(), Catch::Contains("priors is 'worst'") && Catch::Contains("poor, bad"));
  }
  CHECK(num_entries(temporary.path()) == 0);
}

TEST_CASE("A damaged scene is made again") {
  const QuietFolder temporary;
  const fs::path a = temporary.path() / "a";
  REQUIRE(make_glassroom(kTiny, a, false));
  const Json hashes = file_hashes(a);
  const fs::path picture = a / "images/0000/000000.png";
  REQUIRE(fs::exists(picture));
  std::string bytes = read_file(picture);
  bytes[bytes.size() / 2] ^= 1;
  write_file(picture, bytes);
  CHECK(make_glassroom(kTiny, a, false));
  CHECK(file_hashes(a) == hashes);
  fs::remove(picture);
  CHECK(make_glassroom(kTiny, a, false));
  const std::string description = read_file(a / "scene.json");
  write_file(a / "scene.json", description.substr(0, description.size() / 2));
  CHECK(make_glassroom(kTiny, a, true));
  CHECK(file_hashes(a) == hashes);
}
