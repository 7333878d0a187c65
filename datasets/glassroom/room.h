// SPDX-License-Identifier: MIT
// A furnished room: shell, windows, door, ceiling lights, furniture and pictures; the container
// comes later. The floor is the rectangle |x| <= size.x / 2, |y| <= size.y / 2 at z = 0.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "datasets/glassroom/furniture.h"
#include "datasets/glassroom/room_programs.h"

namespace glint {

struct PlacedItem {
  std::string kind;  // "sofa", "window", "picture", ...
  int wall = -1;     // index of the wall it belongs to; -1: none
  Bounds bounds;     // metres, world
};

struct RoomModel {
  Vec3f size{};  // width, depth, height in metres
  TraceScene scene;
  std::vector<PlacedItem> items;              // pairwise disjoint; the rug is not among them
  Vec2f container_place{};                    // where the container is dropped
  float container_yaw = 0, yaw_range = 0.6f;  // turned by the first, give or take the second
  float support_height = 0;                   // top of the rug that it lands on
  Bounds bounds() const {
    return {
        .low = {-0.5f * size.x, -0.5f * size.y, 0}, .high = {0.5f * size.x, 0.5f * size.y, size.z}};
  }
};

// Deterministic in (program, seed). Errors (kEnvironment): the furniture does not fit along a wall.
RoomModel build_room(const RoomProgram& program, std::uint64_t seed);

}  // namespace glint
