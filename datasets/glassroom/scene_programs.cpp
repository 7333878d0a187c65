// SPDX-License-Identifier: MIT
#include "datasets/glassroom/scene_programs.h"

#include <algorithm>
#include <string>

#include "glint/core/error.h"

namespace glint {

namespace {

using enum FurnitureKind;

// The room's finishes for a scene of another name, which seeds another layout.
RoomProgram room_like(std::string_view room, std::string_view name) {
  const std::vector<RoomProgram>& rooms = room_programs();
  RoomProgram program = *std::ranges::find(rooms, room, &RoomProgram::name);
  program.name = name;
  return program;
}

SceneProgram nested() { return {.room = room_like("room_1", "nested_1"), .nested = true}; }

// A pane between the case and one wall, which has nothing deep before it; cameras go further out,
// to both of its sides.
SceneProgram shop_window() {
  SceneProgram scene{.room = room_like("room_3", "window_1")};
  RoomProgram& room = scene.room;
  room.shop_window = true;
  room.extra_depth = 0.9f;
  room.case_shift = {0, 0.5f};
  room.walls[0].furniture = {kPlant, kFloorLamp};
  room.walls[2].furniture = {kBookshelf, kPlant};
  scene.min_glass = 0.3;
  scene.max_glass = 0.85;
  scene.max_radius = 2.8;
  return scene;
}

// The case stands nearer to the wall with the mirror.
SceneProgram wall_mirror() {
  SceneProgram scene{.room = room_like("room_5", "mirror_1")};
  RoomProgram& room = scene.room;
  room.case_shift = {0, 0.7f};
  room.walls[2].furniture = {};
  room.walls[2].windows = room.walls[2].doors = room.walls[2].pictures = 0;
  room.walls[2].mirrors = 1;
  room.walls[0].doors = 1;
  return scene;
}

// Amber, blue, green and rose round the case, a smoke-grey top; the floor pane is clear.
SceneProgram tinted() {
  return {
      .room = room_like("room_4", "tinted_1"),
      .tints = {
          {{{0.93f, 0.66f, 0.28f},
            {0.35f, 0.62f, 0.92f},
            {0.42f, 0.86f, 0.55f},
            {0.92f, 0.45f, 0.55f},
            {0.97f, 0.98f, 0.97f},
            {0.6f, 0.6f, 0.62f}}}}};
}

}  // namespace

const std::vector<SceneProgram>& scene_programs() {
  static const std::vector<SceneProgram> programs = [] {
    std::vector<SceneProgram> all;
    for (const RoomProgram& room : room_programs()) all.push_back({.room = room});
    for (const auto make : {nested, shop_window, wall_mirror, tinted}) all.push_back(make());
    return all;
  }();
  return programs;
}

const SceneProgram& scene_program(std::string_view name) {
  std::string known;
  for (const SceneProgram& program : scene_programs()) {
    if (program.room.name == name) return program;
    known += (known.empty() ? "" : ", ") + std::string(program.room.name);
  }
  GLINT_CHECK(false, kUsage, "glassroom: no scene '{}'; known scenes: {}", name, known);
  return scene_programs().front();
}

}  // namespace glint
