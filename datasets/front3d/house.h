// SPDX-License-Identifier: MIT
// A house of 3D-FRONT [Fu21]: one JSON file with the architecture as meshes, furniture as
// references to models of 3D-FUTURE, and rooms that say what belongs to them. Read into metres with
// z up: (x, y, z) of the file is (x, -z, y) here, a turn without a mirror image.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "glint/core/files.h"
#include "glint/core/vec.h"

namespace glint {

struct HouseMesh {
  std::string uid, type;        // "Floor", "WallInner", ...; without blanks around it; may be empty
  int material = -1;            // index into House::materials; -1: none, or one that is not there
  std::vector<Vec3f> vertices;  // metres, world, z up
  std::vector<Vec2f> uvs;       // per vertex as in the file, v upwards; empty: none, or not for all
  std::vector<std::array<std::int32_t, 3>> faces;
  std::string kind() const;  // "floor", "wall", "ceiling", ...: surface_kind() of the type
};

struct HouseMaterial {
  std::string uid, jid;  // jid: its folder among the textures; may be empty
  Vec3f color{};         // sRGB, [0, 1]
  bool has_color = false;
  std::array<float, 6> uv_transform{1, 0, 0, 0, 1, 0};  // u' = a u + b v + c, v' = d u + e v + f
};

struct HouseFurniture {
  std::string uid, jid, category;  // jid: its folder among the models
  // In the model's frame, metres, z up: two corners. Sizes alone stand on the origin.
  std::optional<std::array<Vec3f, 2>> box;
};

// x_world = rotation (scale * x_model) + translation, all with z up.
struct HousePlacement {
  std::size_t furniture = 0;  // index into House::furniture
  Mat3f rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3f scale{1, 1, 1}, translation{};
};

struct HouseRoom {
  std::string instanceid, type;
  std::vector<std::size_t> meshes;  // indices into House::meshes, each once
  std::vector<HousePlacement> furniture;
};

struct House {
  std::string uid, sha256;  // of the file
  std::vector<HouseMesh> meshes;
  std::vector<HouseMaterial> materials;
  std::vector<HouseFurniture> furniture;
  std::vector<HouseRoom> rooms;
  std::vector<std::string> notes;  // what was passed over, a line each
};

// Of points and directions in the file and in its models.
inline Vec3f with_z_up(Vec3f v) { return {v.x, -v.z, v.y}; }

// Both forms that such files come in: lists of numbers flat or in rows, furniture with `size` or
// with `bbox`, with `valid` flags or without (docs/reference/datasets.md). What is merely missing
// is passed over with a note. Errors (kBadReference): no JSON object, no rooms, a field of another
// type, lists whose lengths do not fit, indices beyond the vertices, coordinates beyond 10 km, a
// rotation of length 0; they name file, entry and field.
House read_house(const fs::path& file);

// "floor", "wall", "ceiling", "baseboard", "cornice", "door", "window", "slab" or "other".
std::string surface_kind(const std::string& type);

// Horizontal area of its floor, m^2.
double floor_area(const House& house, const HouseRoom& room);
// The room with that instanceid; empty: the one with the largest floor. Errors (kUsage): no such
// room, the known ones are listed; (kBadReference): no room has a floor. `file` opens the message.
const HouseRoom& choose_room(
    const House& house, const std::string& instanceid, const fs::path& file
);

}  // namespace glint
