// SPDX-License-Identifier: MIT
#include "datasets/front3d/house_room.h"

#include <sys/stat.h>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "datasets/front3d/surface_mesh.h"
#include "datasets/glassroom/path_tracer.h"
#include "datasets/glassroom/validate_scene.h"
#include "glint/scene/image_files.h"
#include "tests/datasets/front3d/houses.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

FurnishedRoom furnished(
    const House& house, const HouseRoomOptions& options = {}, const char* room = kLivingRoom
) {
  return furnish_house_room(house, choose_room(house, room, kFlatHouse), options, "the room");
}

const HousePiece& piece_of(const FurnishedRoom& room, const std::string& category) {
  for (const HousePiece& piece : room.pieces)
    if (piece.category.find(category) != std::string::npos) return piece;
  throw std::logic_error("no " + category);
}

const Material& material_of(const FurnishedRoom& room, const std::string& mesh_name) {
  for (const TraceMesh& mesh : room.room.scene.meshes)
    if (mesh.name == mesh_name)
      return room.room.scene.materials[static_cast<std::size_t>(mesh.material)];
  throw std::logic_error("no mesh " + mesh_name);
}

bool is_at(const Bounds& bounds, Vec3f low, Vec3f high) {
  return length(bounds.low - low) < 1e-4f && length(bounds.high - high) < 1e-4f;
}

// The clearance of the free spot nearest to a place; 0: it is not free.
float clearance_at(const FloorPlan& plan, Vec2f p) {
  for (const FloorPlan::Spot& spot : plan.free_spots())
    if (std::max(std::abs(spot.place.x - p.x), std::abs(spot.place.y - p.y)) <= 0.026f)
      return spot.clearance;
  return 0;
}

}  // namespace

// The file's x in [1, 7], z in [-2, 3]; the room's frame has its middle (4, 0.5) in the origin.
TEST_CASE("a room stands on the origin, with its furniture as models or boxes of the right size") {
  const TempFolder folder;
  write_sofa(folder.path());
  const FurnishedRoom room = furnished(read_house(kFlatHouse), {.models = folder.path()});
  CHECK_NOTHROW(validate_scene(room.room.scene));
  CHECK(room.room.size.x == Approx(6));
  CHECK(room.room.size.y == Approx(5));
  CHECK(room.room.size.z == Approx(2.8));
  CHECK(length(room.origin - Vec3f{4, -0.5f, 0}) < 1e-5f);
  REQUIRE(room.pieces.size() == 5);
  const HousePiece& sofa = piece_of(room, "Sofa");
  CHECK(sofa.has_model);
  CHECK(is_at(sofa.bounds, {-1, 1.5f, 0}, {1, 2.4f, 0.8f}));
  // Its low side is the model's +z, which is -y here.
  for (const TraceMesh& mesh : room.room.scene.meshes)
    if (mesh.name == sofa.category)
      for (const Vec3f v : mesh.vertices)
        if (v.z > 0.4f) CHECK(v.y == Approx(2.4f).margin(1e-4));
  const HousePiece& wardrobe = piece_of(room, "Wardrobe");
  CHECK_FALSE(wardrobe.has_model);
  CHECK(is_at(wardrobe.bounds, {2.35f, 0.6f, 0}, {2.95f, 2.2f, 2.2f}));
  CHECK(is_at(piece_of(room, "Lamp").bounds, {-1, -0.2f, 2.3f}, {-0.6f, 0.2f, 2.65f}));
}

TEST_CASE("no model shines, and one picture is that of the whole model") {
  const TempFolder folder;
  write_sofa(folder.path());
  const House house = read_house(kFlatHouse);
  const Material plain =
      material_of(furnished(house, {.models = folder.path()}), "Three-Seat Sofa");
  CHECK(plain.emission.x == 0);
  CHECK(plain.texture == -1);
  CHECK(plain.albedo.x == Approx(0.7));
  write_png(folder.path() / "sofa-with-a-model" / "texture.png", Image(4, 4, 3, 0.5f));
  CHECK(material_of(furnished(house, {.models = folder.path()}), "Three-Seat Sofa").texture >= 0);
}

TEST_CASE("models read nothing outside of their folder, and names lead nowhere else") {
  const TempFolder folder;
  const fs::path models = folder.path() / "models";
  write_png(folder.path() / "secret.png", Image(4, 4, 3, 0.5f));
  write_sofa(models, "map_Kd ../../secret.png\n");
  const House house = read_house(kFlatHouse);
  CHECK_THAT(
      bad_reference([&] { furnished(house, {.models = models}); }),
      Contains("secret.png") && Contains("outside")
  );
  write_sofa(models);
  write_file(folder.path() / "out.mtl", "newmtl cloth\nKd 0 1 0\n");
  const fs::path model = models / "sofa-with-a-model" / "raw_model.obj";
  std::string text = read_file(model);
  text.replace(0, text.find('\n'), "mtllib ../../out.mtl");
  write_file(model, text);
  CHECK(material_of(furnished(house, {.models = models}), "Three-Seat Sofa").albedo.y != Approx(1));

  Json other = flat_house();
  entry(other, "furniture", "sofa")["jid"] = "../models/sofa-with-a-model";
  const House leads_out = read_house(written(folder.path() / "house.json", other));
  CHECK_FALSE(piece_of(furnished(leads_out, {.models = models}), "Sofa").has_model);
}

TEST_CASE("a model that cannot be read is an error that names it") {
  const TempFolder folder;
  const fs::path model = folder.path() / "sofa-with-a-model" / "raw_model.obj";
  for (const char* text : {"", "v 1 2 3\n", "nothing of the kind"}) {
    write_file(model, text);
    CHECK_THAT(
        bad_reference([&] { furnished(read_house(kFlatHouse), {.models = folder.path()}); }),
        Contains("raw_model.obj")
    );
  }
  fs::remove(model);
  REQUIRE(::mkfifo(model.c_str(), 0600) == 0);
  CHECK_THAT(
      bad_reference([&] { furnished(read_house(kFlatHouse), {.models = folder.path()}); }),
      Contains("raw_model.obj: is a pipe")
  );
}

TEST_CASE("no ray leaves the room, through windows, doors or seams, and the window is bright") {
  for (const char* name : {kLivingRoom, kBedroom}) {
    const FurnishedRoom room = furnished(read_house(kFlatHouse), {}, name);
    const PathTracer tracer(room.room.scene);
    std::size_t sky = 0;
    Rng rng(7);
    for (int i = 0; i < 20000; ++i) {
      const Vec3f direction = normalize(Vec3f{rng.normal(), rng.normal(), rng.normal()});
      const auto hit = tracer.first_hit({-0.5f, 0, 1.4f}, direction, false);
      REQUIRE(hit.hit);
      sky += room.room.scene.meshes[static_cast<std::size_t>(hit.mesh)].name == "sky";
    }
    // The living room's window is 2 x 1.3 m, 2.5 m away, behind a mullion; the wall of the bedroom
    // that the same window touches has no hole.
    CHECK((name == kLivingRoom) == (sky > 200));
  }
}

// A ray from the middle through the open door meets a slab, at most a wall's thickness beyond it.
TEST_CASE("a door to nowhere ends at a slab") {
  const FurnishedRoom room = furnished(read_house(kFlatHouse));
  const PathTracer tracer(room.room.scene);
  const auto hit = tracer.first_hit({-2.5f, -1.05f, 1}, {-1, 0, 0}, false);  // z = 1.55 of the file
  REQUIRE(hit.hit);
  CHECK(room.room.scene.meshes[static_cast<std::size_t>(hit.mesh)].name == "slab");
  CHECK(hit.t < 1);
}

TEST_CASE("the plan knows the floor's shape, what stands on it, and its outline") {
  const FurnishedRoom room = furnished(read_house(kFlatHouse));
  CHECK(room.plan.is_floor({0, 0}));
  CHECK_FALSE(room.plan.is_floor({2, -1.5f}));  // the notch
  CHECK_FALSE(room.plan.is_floor({3.1f, 0}));
  CHECK(clearance_at(room.plan, {0, 2}) == 0);        // under the sofa
  CHECK(clearance_at(room.plan, {2.6f, 1.5f}) == 0);  // under the wardrobe
  CHECK(clearance_at(room.plan, {-0.8f, 0}) > 1);     // under the lamp, on the rug
  // From the wall x = -3: half a cell is the grid's error.
  CHECK(clearance_at(room.plan, {-2.5f, 0.5f}) == Approx(0.5f).margin(0.051));
  double outline = 0;
  for (const FloorPlan::Side& side : room.plan.sides()) {
    outline += static_cast<double>(side.length);
    const Vec2f middle = side.start + 0.5f * side.length * side.along;
    CHECK_FALSE(room.plan.is_floor(middle + 0.1f * side.outward));
    CHECK(room.plan.is_floor(middle - 0.1f * side.outward));
  }
  CHECK(outline == Approx(22));
}

TEST_CASE("pictures are those of the house's materials, or of the kind of surface") {
  const TempFolder folder;
  write_png(folder.path() / "wall-jid" / "texture.png", Image(8, 8, 3, 0.25f));
  write_png(folder.path() / "floor_oak.png", Image(8, 8, 3, 0.75f));
  const FurnishedRoom room = furnished(read_house(kFlatHouse), {.textures = folder.path()});
  CHECK_NOTHROW(validate_scene(room.room.scene));
  const auto brightness = [&](const std::string& mesh) {
    const int texture = material_of(room, mesh).texture;
    REQUIRE(texture >= 0);
    return srgb_encode(room.room.scene.textures[static_cast<std::size_t>(texture)].at(0, 0, 0));
  };
  CHECK(brightness("Floor") == Approx(0.75).margin(0.01));
  // Of the walls those with whole texture coordinates; 2 x their uv, by the material's transform.
  std::size_t own = 0;
  for (const TraceMesh& mesh : room.room.scene.meshes) {
    const Material& m = room.room.scene.materials[static_cast<std::size_t>(mesh.material)];
    if (m.name != "wall-jid") continue;
    ++own;
    float largest = 0;
    for (const Vec2f uv : mesh.uvs) largest = std::max(largest, uv.x);
    CHECK(largest == 4);
  }
  CHECK(own == 4);
}

TEST_CASE("the same seed gives the same finishes, another one others") {
  const House house = read_house(kFlatHouse);
  const auto floor_of = [&](std::uint64_t seed) {
    const FurnishedRoom room = furnished(house, {.seed = seed});
    const int texture = material_of(room, "Floor").texture;
    const auto& values = room.room.scene.textures[static_cast<std::size_t>(texture)].values();
    return std::vector<float>(values.begin(), values.end());
  };
  CHECK(floor_of(1) == floor_of(1));
  CHECK(floor_of(1) != floor_of(2));
}

TEST_CASE("rooms in another unit, or of endless surface, are refused") {
  House house = read_house(kFlatHouse);
  for (HouseMesh& mesh : house.meshes)
    for (Vec3f& v : mesh.vertices) v = 9.0f * v;
  CHECK_THAT(bad_reference([&] { furnished(house); }), Contains("the room") && Contains("25.2"));
  for (HouseMesh& mesh : house.meshes)
    for (Vec3f& v : mesh.vertices) v = {3 * v.x, 3 * v.y, v.z / 9};
  CHECK_THAT(bad_reference([&] { furnished(house); }), Contains("at most 60 m"));
  House many = read_house(kFlatHouse);
  for (HouseMesh& mesh : many.meshes)
    if (mesh.uid == "c1") mesh.faces.insert(mesh.faces.end(), 10000, mesh.faces.front());
  CHECK_THAT(bad_reference([&] { furnished(many); }), Contains("m^2"));
}

TEST_CASE("texture coordinates are metres along the surface") {
  const HouseMesh wall{
      .uid = "a",
      .type = "WallInner",
      .vertices = {{1, 1, 0}, {4, 5, 0}, {4, 5, 2}, {1, 1, 2}},
      .faces = {{0, 1, 2}, {0, 2, 3}, {0, 0, 1}}};
  const TraceMesh mesh = surface_mesh(wall, {1, 1, 0});
  REQUIRE(mesh.faces.size() == 2);  // the third has no area
  CHECK(area_of(mesh) == Approx(10));
  const Vec2f along = mesh.uvs[1] - mesh.uvs[0], up = mesh.uvs[2] - mesh.uvs[1];
  CHECK(std::abs(along.x) == Approx(5));
  CHECK(std::abs(along.y) < 1e-5f);
  CHECK(std::abs(up.x) < 1e-5f);
  CHECK(up.y == Approx(-2));  // rows of a picture go down
}
