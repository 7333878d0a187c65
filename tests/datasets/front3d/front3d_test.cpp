// SPDX-License-Identifier: MIT
#include "datasets/front3d/front3d.h"

#include <catch2/catch.hpp>

#include <set>

#include "datasets/dataset.h"
#include "datasets/front3d/front3d_scene.h"
#include "datasets/glassroom/glassroom.h"
#include "datasets/glassroom/write_scene.h"
#include "glint/core/progress.h"
#include "tests/datasets/front3d/houses.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

const Front3dOptions kTiny{
    .house = kFlatHouse.string(), .width = 32, .height = 18, .views = 9, .spp = 2};

Json scene_of(const fs::path& folder) { return Json::parse(read_file(folder / "scene.json")); }

}  // namespace

TEST_CASE("a room of a house becomes a folder that loads, has both layers and says what it is") {
  set_quiet(true);
  const TempFolder temporary;
  const fs::path a = temporary / "a", b = temporary / "b";
  write_sofa(temporary / "models");
  Front3dOptions options = kTiny;
  options.models = (temporary / "models").string();
  REQUIRE(make_front3d(options, a, false));
  CHECK_FALSE(make_front3d(options, a, false));
  REQUIRE(make_front3d(options, b, false));
  CHECK(file_hashes(a) == file_hashes(b));
  CHECK(check_dataset(a).empty());
  const Scene scene = load_scene(a, {});
  CHECK(scene.dataset == "front3d");
  CHECK(scene.simulated_priors);
  CHECK(scene.train.size() == 7);
  CHECK(scene.test.size() == 2);
  for (const MapId map : {MapId("depth"), MapId("behind_depth"), MapId("normal"), MapId("glass")})
    CHECK(scene.test[0].truth.has(map));
  const Json json = scene_of(a);
  CHECK(json["name"] == "house_flat-LivingDiningRoom-2");
  CHECK(json["hash"] == front3d_hash(options));
  CHECK(json["house"]["room"] == kLivingRoom);
  CHECK(json["house"]["uid"] == "house-of-two-rooms");
  CHECK(json["house"]["sha256"] == read_house(kFlatHouse).sha256);
  CHECK(json["house"]["left_out"].size() == 5);
  CHECK(json["furniture"].size() == 5);
  CHECK(json["contents"].size() == 6);
  CHECK(json["container"]["panes"].size() == 6);
  CHECK(json["container_visible"].size() == 9);
}

TEST_CASE("the container stands on free floor, and cameras above the floor see it") {
  set_quiet(true);
  for (const std::uint64_t seed : {0u, 1u, 2u}) {
    Front3dOptions options = kTiny;
    options.seed = seed;
    options.views = 24;
    const ChosenRoom chosen = choose_front3d_room(options);
    const FurnishedRoom furnished = furnish_front3d_room(chosen, options);
    const auto scene = build_front3d_scene(furnished, chosen, options);
    INFO(seed);
    CHECK(scene->glass_share > 0.08);
    const Bounds& box = scene->container_bounds;
    CHECK(scene->room.bounds().contains(box));
    for (const HousePiece& piece : furnished.pieces) {
      INFO(piece.category);
      const bool is_rug = piece.category == "Rug";
      CHECK((is_rug || !piece.bounds.overlaps(box)));
    }
    for (const float x : {box.low.x, box.high.x})
      for (const float y : {box.low.y, box.high.y}) CHECK(furnished.plan.is_floor({x, y}));
    for (const Camera& camera : scene->cameras) {
      const Vec3f eye = cast<float>(camera.center());
      CHECK(furnished.plan.is_floor({eye.x, eye.y}));
      CHECK(container_visibility(*scene->tracer, box, camera) >= 0.7);
      for (const HousePiece& piece : furnished.pieces) CHECK_FALSE(piece.bounds.contains(eye));
    }
  }
}

TEST_CASE("the cache key follows what files hold, not where they lie") {
  const TempFolder temporary;
  Front3dOptions options = kTiny;
  const std::string key = front3d_hash(options);
  options.house = (temporary / "moved.json").string();
  write_file(options.house, read_file(kFlatHouse));
  CHECK(front3d_hash(options) == key);
  write_file(options.house, read_file(kFlatHouse) + " ");
  CHECK(front3d_hash(options) != key);
  options = kTiny;
  options.room = kLivingRoom;  // what is chosen without a name
  CHECK(front3d_hash(options) == key);
  options.room = kBedroom;
  CHECK(front3d_hash(options) != key);
  options = kTiny;
  options.seed = 1;
  CHECK(front3d_hash(options) != key);
  options = kTiny;
  options.models = (temporary / "models").string();
  CHECK_THAT(bad_reference([&] { front3d_hash(options); }), Contains("no such folder of models"));
  write_sofa(options.models);
  const std::string with_sofa = front3d_hash(options);
  CHECK(with_sofa != key);
  write_file(fs::path(options.models) / "some-other-model" / "raw_model.obj", "v 0 0 0\n");
  CHECK(front3d_hash(options) == with_sofa);
  write_sofa(options.models, "Ns 5\n");
  CHECK(front3d_hash(options) != with_sofa);
  options = kTiny;
  options.textures = (temporary / "textures").string();
  write_file(temporary / "textures" / "wall-jid" / "texture.png", "a");
  write_file(temporary / "textures" / "not-of-the-house" / "texture.png", "a");
  const std::string with_wall = front3d_hash(options);
  write_file(temporary / "textures" / "not-of-the-house" / "texture.png", "b");
  CHECK(front3d_hash(options) == with_wall);
  write_file(temporary / "textures" / "wall-jid" / "texture.png", "b");
  CHECK(front3d_hash(options) != with_wall);
}

TEST_CASE("a room without a free place, a wrong room and foreign folders are errors") {
  set_quiet(true);
  const TempFolder temporary;
  Front3dOptions options = kTiny;
  options.room = kBedroom;
  Json house = flat_house();
  entry(house, "furniture", "bed")["size"] = {2.6, 0.9, 2.4};
  options.house = written(temporary / "house.json", house).string();
  CHECK_THAT(
      bad_reference([&] { make_front3d(options, temporary / "x", false); }),
      Contains("house.json") && Contains(kBedroom) && Contains("free spot")
  );
  options = kTiny;
  options.room = "Attic";
  CHECK_THAT(
      error_of(ExitCode::kUsage, [&] { make_front3d(options, temporary / "x", false); }),
      Contains("Attic")
  );
  options.house.clear();
  CHECK_THAT(error_of(ExitCode::kUsage, [&] { front3d_hash(options); }), Contains("--house"));
  CHECK_FALSE(fs::exists(temporary / "x"));

  const fs::path other = temporary / "glassroom";
  make_glassroom({.width = 32, .height = 18, .views = 2, .spp = 1}, other, false);
  const Json before = file_hashes(other);
  CHECK_THAT(
      error_of(ExitCode::kUsage, [&] { make_front3d(kTiny, other, false); }),
      Contains("not a 3D-FRONT scene")
  );
  CHECK(file_hashes(other) == before);
}

TEST_CASE("the name of a scene is one for folders") {
  const TempFolder temporary;
  Json house = flat_house();
  house["scene"]["room"][1]["instanceid"] = "../Living Room\x1b[31m";
  Front3dOptions options = kTiny;
  options.house = written(temporary / "a b.json", house).string();
  CHECK(front3d_name(options) == "a_b-___Living_Room__31m");
}
