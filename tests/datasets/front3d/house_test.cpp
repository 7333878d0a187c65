// SPDX-License-Identifier: MIT
#include "datasets/front3d/house.h"

#include <catch2/catch.hpp>

#include <functional>
#include <set>

#include "tests/datasets/front3d/houses.h"
#include "tests/support/temp_folder.h"

using namespace glint;
using namespace glint::test;
using Catch::Contains;

namespace {

bool same(Vec3f a, Vec3f b) { return length(a - b) < 1e-5f; }

const HouseRoom& room_of(const House& house, const std::string& id) {
  return choose_room(house, id, "house.json");
}

const HousePlacement& placement_of(const House& house, const HouseRoom& room, const char* uid) {
  for (const HousePlacement& placement : room.furniture)
    if (house.furniture[placement.furniture].uid == uid) return placement;
  throw std::logic_error(uid);
}

void check_same_meshes(const House& a, const House& b) {
  REQUIRE(a.meshes.size() == b.meshes.size());
  for (std::size_t i = 0; i < a.meshes.size(); ++i) {
    const HouseMesh &p = a.meshes[i], &q = b.meshes[i];
    INFO(p.uid);
    CHECK(p.uid == q.uid);
    CHECK(p.type == q.type);
    CHECK(p.material == q.material);
    CHECK(p.faces == q.faces);
    CHECK(p.uvs.size() == q.uvs.size());
    REQUIRE(p.vertices.size() == q.vertices.size());
    for (std::size_t v = 0; v < p.vertices.size(); ++v) CHECK(same(p.vertices[v], q.vertices[v]));
  }
}

// What reading a house says that `change` has damaged; it must refuse it.
std::string refusal(const std::function<void(Json&)>& change) {
  const TempFolder folder;
  Json house = flat_house();
  change(house);
  const fs::path file = written(folder / "house.json", house);
  const std::string message = bad_reference([&] { read_house(file); });
  CHECK_THAT(message, Contains(file.string()));
  CHECK(message.size() < 1000);
  return message;
}

}  // namespace

TEST_CASE("both forms of the file are the same house") {
  const House flat = read_house(kFlatHouse), rows = read_house(kRowsHouse);
  CHECK(flat.uid == "house-of-two-rooms");
  CHECK(flat.sha256 != rows.sha256);
  check_same_meshes(flat, rows);
  REQUIRE(flat.rooms.size() == 2);
  REQUIRE(rows.rooms.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(flat.rooms[i].meshes == rows.rooms[i].meshes);
    REQUIRE(flat.rooms[i].furniture.size() == rows.rooms[i].furniture.size());
    for (std::size_t k = 0; k < flat.rooms[i].furniture.size(); ++k) {
      const HousePlacement &p = flat.rooms[i].furniture[k], &q = rows.rooms[i].furniture[k];
      const HouseFurniture &a = flat.furniture[p.furniture], &b = rows.furniture[q.furniture];
      INFO(a.uid);
      CHECK(a.category == b.category);
      CHECK(same(p.translation, q.translation));
      REQUIRE((a.box && b.box));
      for (std::size_t corner = 0; corner < 2; ++corner)
        CHECK(same((*a.box)[corner], (*b.box)[corner]));
    }
  }
}

TEST_CASE("what is missing, invalid or there twice is passed over, and counted") {
  const House house = read_house(kFlatHouse);
  CHECK(mesh_of(house, "f1").type == "Floor");      // blanks behind it
  CHECK(mesh_of(house, "w6").type == "WallInner");  // and around it
  CHECK(mesh_of(house, "w1").uvs.empty());          // nulls
  CHECK(mesh_of(house, "w2").uvs.size() == 4);
  CHECK(mesh_of(house, "w6").material == -1);  // none
  CHECK(mesh_of(house, "b2").material == -1);  // one that is not there
  CHECK(mesh_of(house, "w2").material >= 0);
  std::set<std::string> placed;
  for (const HousePlacement& placement : room_of(house, kLivingRoom).furniture)
    placed.insert(house.furniture[placement.furniture].uid);
  CHECK(placed == std::set<std::string>{"sofa", "cabinet", "wardrobe", "rug", "lamp"});
  const std::set<std::string> notes(house.notes.begin(), house.notes.end());
  CHECK(notes.contains("1 pieces of furniture that are not valid"));
  CHECK(notes.contains("1 pieces scaled to nothing, mirrored or scaled beyond 5"));
  CHECK(notes.contains("1 pieces that stand twice in one place"));
  CHECK(notes.contains("1 references to nothing"));
  CHECK(notes.contains("1 rooms whose instanceid another one has"));
  CHECK(notes.size() == 5);
}

TEST_CASE("z is up without a mirror image, and furniture stands as the file's formula says") {
  const Mat3f turn{{with_z_up({1, 0, 0}), with_z_up({0, 1, 0}), with_z_up({0, 0, 1})}};  // columns
  CHECK(determinant(turn) == 1);
  const House house = read_house(kFlatHouse);
  CHECK(same(mesh_of(house, "f1").vertices[0], {1, 2, 0}));  // (1, 0, -2)
  // The wardrobe is turned by -90 degrees about the file's y: its front, +z, looks to -x.
  const HousePlacement& wardrobe = placement_of(house, room_of(house, kLivingRoom), "wardrobe");
  const Vec3f front = with_z_up({0, 0, 1});
  CHECK(same(wardrobe.rotation * front, {-1, 0, 0}));
  CHECK(same(wardrobe.rotation * Vec3f{0, 0, 1}, {0, 0, 1}));
  CHECK(same(wardrobe.translation, {6.65f, 0.9f, 0}));
  CHECK(determinant(wardrobe.rotation) == Approx(1));
}

TEST_CASE("any quaternion and scale place a point as R (s v) + p does, before z is up") {
  const TempFolder folder;
  Json house = flat_house();
  const double q[4] = {0.1, -0.5, 0.3, 0.8};  // x, y, z, w; not of unit length
  Json& room = house["scene"]["room"][1];
  for (Json& child : room["children"])
    if (child["ref"] == "sofa") {
      child["rot"] = q;
      child["scale"] = {1.5, 0.5, 2};
    }
  const House read = read_house(written(folder / "house.json", house));
  const HousePlacement& sofa = placement_of(read, room_of(read, kLivingRoom), "sofa");
  const Vec3d v{0.7, 0.2, -0.4}, scaled{1.5 * v.x, 0.5 * v.y, 2 * v.z};
  // v + 2 w (u x v) + 2 u x (u x v), of the unit quaternion.
  const double norm = std::sqrt(0.01 + 0.25 + 0.09 + 0.64);
  const Vec3d u{q[0] / norm, q[1] / norm, q[2] / norm}, once = cross(u, scaled);
  const Vec3d there = scaled + (2 * q[3] / norm) * once + 2.0 * cross(u, once) + Vec3d{4, 0, -1.45};
  const Vec3f found =
      sofa.rotation * hadamard(sofa.scale, with_z_up(cast<float>(v))) + sofa.translation;
  CHECK(same(found, with_z_up(cast<float>(there))));
}

TEST_CASE("the room with the largest floor is chosen, or the one that is named") {
  const House house = read_house(kFlatHouse);
  CHECK(choose_room(house, "", kFlatHouse).instanceid == kLivingRoom);
  CHECK(floor_area(house, room_of(house, kLivingRoom)) == Approx(26));
  CHECK(floor_area(house, room_of(house, kBedroom)) == Approx(8.4));
  CHECK_THAT(
      error_of(ExitCode::kUsage, [&] { choose_room(house, "Attic", kFlatHouse); }),
      Contains("Attic") && Contains("house_flat.json") && Contains("MasterBedroom-1 (8.4 m^2)")
  );
  House without = house;
  for (HouseMesh& mesh : without.meshes) mesh.type = "Ceiling";
  CHECK_THAT(bad_reference([&] { choose_room(without, "", kFlatHouse); }), Contains("type Floor"));
}

TEST_CASE("kinds of surfaces go by words of the type") {
  CHECK(surface_kind("Floor") == "floor");
  CHECK(surface_kind("CustomizedCeiling") == "ceiling");
  CHECK(surface_kind("WallOuter") == "wall");
  CHECK(surface_kind("BayWindow") == "window");
  CHECK(surface_kind("SlabTop") == "slab");
  CHECK(surface_kind("Hole") == "other");
  CHECK(surface_kind("") == "other");
}

TEST_CASE("a damaged house is refused with file, entry and field") {
  const auto mesh = [](Json& house) -> Json& { return entry(house, "mesh", "w2"); };
  CHECK_THAT(
      refusal([&](Json& h) {
        mesh(h)["faces"] = {0, 1, 4};
      }),
      Contains("vertex 4, but xyz has 4")
  );
  CHECK_THAT(refusal([&](Json& h) { mesh(h)["faces"] = {0, 1, -1}; }), Contains("vertex -1"));
  CHECK_THAT(refusal([&](Json& h) { mesh(h)["faces"] = {0, 1, 1.5}; }), Contains("vertex 1.5"));
  CHECK_THAT(refusal([&](Json& h) { mesh(h)["faces"] = {0, 1}; }), Contains("multiple of 3"));
  CHECK_THAT(refusal([&](Json& h) { mesh(h)["xyz"].push_back(1); }), Contains("xyz has 13"));
  CHECK_THAT(
      refusal([&](Json& h) { mesh(h)["xyz"][3] = nullptr; }), Contains("value 3 of xyz is null")
  );
  CHECK_THAT(refusal([&](Json& h) { mesh(h)["xyz"][0] = 1e200; }), Contains("1e+200 m"));
  CHECK_THAT(refusal([&](Json& h) { mesh(h)["xyz"] = "none"; }), Contains("xyz is string"));
  CHECK_THAT(refusal([&](Json& h) { mesh(h)["type"] = 5; }), Contains("type is number"));
  CHECK_THAT(refusal([&](Json& h) { h["mesh"] = 5; }), Contains("mesh is number"));
  CHECK_THAT(refusal([&](Json& h) { h["mesh"][2] = Json::array(); }), Contains("mesh 2 is array"));
  CHECK_THAT(refusal([&](Json& h) { h["furniture"][0]["size"] = {1, "2", 3}; }), Contains("size"));
  CHECK_THAT(refusal([](Json& h) { h.erase("scene"); }), Contains("`scene`"));
  CHECK_THAT(refusal([](Json& h) { h["scene"] = 1; }), Contains("`scene`"));
  CHECK_THAT(refusal([](Json& h) { h["scene"]["room"] = Json::array(); }), Contains("no room"));
  const auto sofa = [](Json& house) -> Json& {
    for (Json& child : house["scene"]["room"][1]["children"])
      if (child["ref"] == "sofa") return child;
    throw std::logic_error("no sofa");
  };
  CHECK_THAT(refusal([&](Json& h) { sofa(h)["rot"] = {0, 0, 0, 0}; }), Contains("quaternion"));
  CHECK_THAT(refusal([&](Json& h) { sofa(h)["rot"] = {0, 1}; }), Contains("2 numbers"));
  CHECK_THAT(refusal([&](Json& h) { sofa(h)["pos"] = {0, 1}; }), Contains("pos has 2 numbers"));
  CHECK_THAT(refusal([&](Json& h) { sofa(h)["pos"] = {0, 1, -2e4}; }), Contains("-20000"));
  CHECK_THAT(refusal([&](Json& h) { sofa(h)["ref"] = Json::array(); }), Contains("ref is array"));
}

TEST_CASE("text that is no house, too deep or not finite is refused") {
  const TempFolder folder;
  for (const std::string& text :
       {std::string(),
        std::string("[]"),
        std::string("{"),
        std::string(200000, '['),
        std::string("{\"mesh\":[{\"uid\":\"a\",\"xyz\":[NaN,0,0]}]}"),
        std::string("{\"mesh\":[{\"uid\":\"a\",\"xyz\":[1e999,0,0]}]}")}) {
    INFO(text.substr(0, 60));
    write_file(folder / "house.json", text);
    CHECK_THAT(bad_reference([&] { read_house(folder / "house.json"); }), Contains("house.json"));
  }
  CHECK_THAT(bad_reference([&] { read_house(folder / "gone.json"); }), Contains("gone.json"));
}

// Rooms hold meshes and furniture, never rooms: what points at itself points at nothing.
TEST_CASE("references in a circle are references to nothing") {
  const TempFolder folder;
  Json house = flat_house();
  Json& room = house["scene"]["room"][1];
  for (const char* ref : {kLivingRoom, "house-of-two-rooms", ""})
    room["children"].push_back({{"ref", ref}, {"children", room["children"]}});
  const House read = read_house(written(folder / "house.json", house));
  CHECK(read.rooms[1].meshes.size() == read_house(kFlatHouse).rooms[1].meshes.size());
  CHECK(std::count(read.notes.begin(), read.notes.end(), "4 references to nothing") == 1);
}
