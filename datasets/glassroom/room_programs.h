// SPDX-License-Identifier: MIT
// What each of the five rooms consists of: finishes and the furniture of its walls. Sizes,
// positions, mirroring and details come from the seed.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "datasets/glassroom/furniture.h"
#include "datasets/glassroom/patterns.h"

namespace glint {

struct WallProgram {
  PatternSpec finish;
  std::vector<FurnitureKind> furniture;
  int windows = 0, doors = 0, pictures = 0, mirrors = 0;
};

struct RoomProgram {
  std::string_view name;  // "room_1" ...
  PatternSpec floor, rug, wood, dark_wood, fabric, cushion, books;
  Vec3f paint, ceramic, pot, curtain;  // linear colours
  std::array<WallProgram, 4> walls;    // facing +y, -x, -y, +x; neighbours share a corner
  bool shop_window = false;            // a framed pane between the container and the first wall
  float extra_depth = 0;               // metres, along y
  Vec2f case_shift{};                  // of the container's place off the middle
};

const std::vector<RoomProgram>& room_programs();

}  // namespace glint
