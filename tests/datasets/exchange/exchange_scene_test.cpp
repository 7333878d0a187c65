// SPDX-License-Identifier: MIT
#include "datasets/exchange/exchange_scene.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "datasets/exchange/exchange_mesh.h"
#include "datasets/glassroom/fresnel.h"
#include "glint/scene/image_files.h"
#include "tests/datasets/glassroom/trace_scenes.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

ExchangeScene box_room() {
  const Camera camera = room_camera({16, 9});
  return {"box", glass_box_room(), {{"0000", camera, true}, {"0001", camera}}, 0.5f, {}};
}

Json material_called(const Json& scene, const std::string& kind) {
  for (const Json& material : scene["materials"])
    if (material["kind"] == kind) return material;
  FAIL("no material of kind " << kind);
  return {};
}

}  // namespace

TEST_CASE("An exchange scene has every material, texture and camera with what renderers need") {
  const TempFolder folder;
  const ExchangeScene room = box_room();
  write_exchange_scene(room, folder / "box");
  const Json json = read_json_object(folder / "box" / "exchange.json");
  CHECK(json["materials"].size() == room.scene.materials.size());
  CHECK(json["exposure"] == 0.5f);
  CHECK(json["views"].size() == 2);
  CHECK(json["views"][0]["test"] == true);
  CHECK(json["views"][0]["fx"] == room.views[0].camera.fx);
  CHECK(
      json["views"][1]["translation_cam_from_world"][2] ==
      room.views[1].camera.translation_cam_from_world.z
  );

  const Json pane = material_called(json, "thin dielectric");
  CHECK(pane["ior"] == 1.52f);
  CHECK(pane["tint"][0] == 0.97f);
  CHECK(material_called(json, "conductor")["alpha"] == Approx(0.16));
  CHECK_FALSE(material_called(json, "conductor").contains("coat_albedo"));

  const Image texture = read_image(folder / "box" / material_called(json, "diffuse")["texture"]);
  CHECK(std::ranges::equal(texture.values(), room.scene.textures[0].values()));
}

TEST_CASE("The albedo of a smooth coat is Fresnel's reflectance at its cosines") {
  const TempFolder folder;
  ExchangeScene room = box_room();
  for (Material& material : room.scene.materials) material.roughness = 0.05f;
  write_exchange_scene(room, folder / "box");
  const Json json = read_json_object(folder / "box" / "exchange.json");
  const Json albedo = material_called(json, "plastic")["coat_albedo"];
  REQUIRE(albedo.size() == 32);
  for (const std::size_t i : {15u, 20u, 31u}) {
    const float root = static_cast<float>(i) / 31;
    const float fresnel = path_tracing::fresnel_dielectric(root * root, 1.5f);
    CHECK(albedo[i].get<float>() == Approx(fresnel).epsilon(0.02));
  }
}

TEST_CASE("Meshes as OBJ count vertices through the file, and turn textures to its axes") {
  TraceScene scene;
  add_material(scene, diffuse(0.5f));
  add_horizontal(scene, 0, 2, 1);
  add_horizontal(scene, add_material(scene, diffuse(0.5f)), 3, 1);
  scene.meshes[0].name = "floor";
  scene.meshes[1].uvs.clear();
  scene.meshes[1].normals.assign(4, {0, 0, 1});
  const std::string text = exchange_meshes(scene);
  CHECK_THAT(text, Contains("# floor\no mesh_0\nv -1 -1 2\n"));
  CHECK_THAT(text, Contains("vt 0 1\nvt 1 1\nvt 1 0\nvt 0 0\n"));
  CHECK_THAT(text, Contains("usemtl material_0\ns 0\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"));
  CHECK_THAT(text, Contains("vn 0 0 1\nusemtl material_1\ns 1\nf 5//1 6//2 7//3\n"));
}

TEST_CASE("A mirror is exchanged by what it mirrors, a pane by its index and tint") {
  const TempFolder folder;
  ExchangeScene room = box_room();
  room.scene.materials[0] = {.kind = MaterialKind::kMirror, .albedo = {0.9f, 0.8f, 0.7f}};
  write_exchange_scene(room, folder / "out");
  const Json json = Json::parse(read_file(folder / "out" / "exchange.json"));
  const Json& mirror = json["materials"][0];
  CHECK(mirror["kind"] == "mirror");
  CHECK(mirror["albedo"][1] == 0.8f);
  for (const char* none : {"ior", "tint", "roughness"}) CHECK_FALSE(mirror.contains(none));
}

TEST_CASE("An exchange scene takes the place of nothing that is there") {
  const TempFolder folder;
  const ExchangeScene room = box_room();
  write_file(folder / "mine" / "notes.txt", "kept");
  const std::string message =
      error_of(ExitCode::kUsage, [&] { write_exchange_scene(room, folder / "mine"); });
  CHECK_THAT(message, Contains("is there already"));
  CHECK(read_file(folder / "mine" / "notes.txt") == "kept");
  fs::create_directories(folder / "empty");
  write_exchange_scene(room, folder / "empty");
  CHECK(fs::exists(folder / "empty" / "meshes.obj"));
}

TEST_CASE("A room for exchange has the cameras, the split and the key of the room that is rendered"
) {
  GlassRoomOptions options;
  options.width = 32;
  options.height = 18;
  options.views = 9;
  const ExchangeScene room = glassroom_for_exchange(options);
  REQUIRE(room.views.size() == 9);
  CHECK(room.views[8].name == "0008");
  CHECK(room.views[0].is_test);
  CHECK_FALSE(room.views[7].is_test);
  CHECK(room.views[8].is_test);
  CHECK(room.origin["hash"] == glassroom_hash(options));
  CHECK(room.exposure > 0);
  CHECK(room.views[3].camera.width == 32);
}
