// SPDX-License-Identifier: MIT
#include "datasets/glassroom/room_programs.h"

namespace glint {

namespace {

using enum FurnitureKind;

PatternSpec pattern(
    PatternKind kind, float period, std::uint32_t a, std::uint32_t b, std::uint32_t c = 0x101010
) {
  return {.kind = kind, .colors = {srgb_hex(a), srgb_hex(b), srgb_hex(c)}, .period = period};
}

const PatternSpec kOak = pattern(PatternKind::kWood, 0.8f, 0xB98A58, 0x8F6236);
const PatternSpec kWalnut = pattern(PatternKind::kWood, 0.8f, 0x5B3A24, 0x3B2415);
const PatternSpec kBeech = pattern(PatternKind::kWood, 0.8f, 0xD9B68C, 0xB88E60);

RoomProgram living_room() {
  const auto wall = pattern(PatternKind::kPlain, 2.0f, 0xD9CDB8, 0xC4B498);
  return {
      .name = "room_1",
      .floor = pattern(PatternKind::kPlanks, 1.2f, 0xA9784B, 0x6E4527, 0x2A1A0E),
      .rug = pattern(PatternKind::kRug, 1, 0x8E2B2B, 0x1F3A5F, 0xD8C08A),
      .wood = kOak,
      .dark_wood = kWalnut,
      .fabric = pattern(PatternKind::kFabric, 0.6f, 0x3F5F7F, 0x6D8BA8),
      .cushion = pattern(PatternKind::kFabric, 0.3f, 0xD08A2E, 0xE8D2A0),
      .books = pattern(PatternKind::kBookSpines, 1, 0x8A2F2A, 0x28506B, 0x3E6B40),
      .paint = srgb_hex(0xE8E2D4),
      .ceramic = srgb_hex(0x2E7F86),
      .pot = srgb_hex(0xA8552F),
      .curtain = srgb_hex(0xB5452F),
      .walls = {
          WallProgram{
              .finish = wall, .furniture = {kFloorLamp, kStool}, .windows = 1, .pictures = 1},
          {.finish = wall, .furniture = {kSofa, kPlant}, .pictures = 2},
          {.finish = pattern(PatternKind::kBricks, 1.0f, 0xA2543A, 0x7C3A28, 0xB8AC9C),
           .furniture = {kBookshelf, kSideboard},
           .pictures = 2},
          {.finish = wall, .furniture = {kArmchair}, .windows = 1, .doors = 1, .pictures = 1}}};
}

RoomProgram study() {
  const auto wall = pattern(PatternKind::kPlain, 2.0f, 0x9FB3A3, 0x849C8C);
  return {
      .name = "room_2",
      .floor = pattern(PatternKind::kParquet, 1.2f, 0xC59A63, 0x94683A, 0x3F2A17),
      .rug = pattern(PatternKind::kRug, 1, 0x26415E, 0xC9B48A, 0x9C3B2E),
      .wood = kWalnut,
      .dark_wood = kWalnut,
      .fabric = pattern(PatternKind::kFabric, 0.6f, 0x7A5133, 0x9A714E),
      .cushion = pattern(PatternKind::kFabric, 0.3f, 0x2F5D50, 0xA9C2A0),
      .books = pattern(PatternKind::kBookSpines, 1, 0x5A2430, 0x6B5A2A, 0x20384F),
      .paint = srgb_hex(0xEDE6D6),
      .ceramic = srgb_hex(0xC7A23A),
      .pot = srgb_hex(0x4A5A66),
      .curtain = srgb_hex(0xE6D9B8),
      .walls = {
          WallProgram{.finish = wall, .furniture = {kBookshelf, kBookshelf, kPlant}, .pictures = 1},
          {.finish = wall, .furniture = {kDesk}, .windows = 1, .pictures = 2},
          {.finish = wall, .furniture = {kArmchair, kFloorLamp}, .windows = 1, .pictures = 2},
          {.finish = pattern(PatternKind::kWallpaper, 1.6f, 0xC9BFA2, 0xB0A27F, 0x53705C),
           .furniture = {kSideboard, kWardrobe},
           .doors = 1,
           .pictures = 1}}};
}

RoomProgram loft() {
  const auto brick = pattern(PatternKind::kBricks, 1.0f, 0xC7B8A6, 0xA89884, 0x8E8474);
  return {
      .name = "room_3",
      .floor = pattern(PatternKind::kTiles, 1.6f, 0xC8C2B6, 0x5E6468, 0x3A3A3A),
      .rug = pattern(PatternKind::kRug, 1, 0xC9B99A, 0x3C6E71, 0x284B63),
      .wood = kBeech,
      .dark_wood = pattern(PatternKind::kWood, 0.8f, 0x4A4A4A, 0x333333),
      .fabric = pattern(PatternKind::kFabric, 0.6f, 0x8A9A5B, 0xB5C18E),
      .cushion = pattern(PatternKind::kFabric, 0.3f, 0x3C6E71, 0xF4F1DE),
      .books = pattern(PatternKind::kBookSpines, 1, 0xE07A5F, 0x3D405B, 0x81B29A),
      .paint = srgb_hex(0xF2F0E8),
      .ceramic = srgb_hex(0xE07A5F),
      .pot = srgb_hex(0xDDD6C8),
      .curtain = srgb_hex(0x5C7F92),
      .walls = {
          WallProgram{.finish = brick, .furniture = {kSofa, kFloorLamp}, .pictures = 3},
          {.finish = brick, .furniture = {kPlant, kDesk}, .windows = 1},
          {.finish = pattern(PatternKind::kPlain, 2.0f, 0xD9A441, 0xC28E2E),
           .furniture = {kMediaUnit, kPlant},
           .pictures = 2},
          {.finish = brick, .furniture = {kBookshelf}, .windows = 1, .doors = 1, .pictures = 1}}};
}

RoomProgram gallery() {
  const auto wall = pattern(PatternKind::kPlain, 2.0f, 0xE9E7E1, 0xD6D2C8);
  return {
      .name = "room_4",
      .floor = pattern(PatternKind::kMarble, 1.6f, 0xE4DFD6, 0x7E7A74, 0x4A4844),
      .rug = pattern(PatternKind::kRug, 1, 0x2F4F3A, 0xC2A35A, 0x7A1F2B),
      .wood = kBeech,
      .dark_wood = kWalnut,
      .fabric = pattern(PatternKind::kFabric, 0.6f, 0x8C2F39, 0xB45A62),
      .cushion = pattern(PatternKind::kFabric, 0.3f, 0x8C2F39, 0xE2C391),
      .books = pattern(PatternKind::kBookSpines, 1, 0x2B2D42, 0x8D99AE, 0xBF4342),
      .paint = srgb_hex(0xDAD7CD),
      .ceramic = srgb_hex(0x3A5BA0),
      .pot = srgb_hex(0x8C6A4A),
      .curtain = srgb_hex(0x7D1D2E),
      .walls = {
          WallProgram{.finish = wall, .furniture = {kStool, kStool, kPlant}, .pictures = 4},
          {.finish = wall, .furniture = {kArmchair, kArmchair}, .windows = 1, .pictures = 2},
          {.finish = pattern(PatternKind::kPlain, 2.0f, 0x46627F, 0x38506A),
           .furniture = {kSideboard, kPlant},
           .pictures = 3},
          {.finish = wall, .furniture = {kStool}, .windows = 1, .doors = 1, .pictures = 2}}};
}

RoomProgram lounge() {
  const auto paper = pattern(PatternKind::kWallpaper, 1.6f, 0x7F8FA6, 0x68788F, 0xD9C9A3);
  return {
      .name = "room_5",
      .floor = pattern(PatternKind::kCarpet, 1.5f, 0x9A8468, 0x6E5B45),
      .rug = pattern(PatternKind::kRug, 1, 0xB9A88A, 0x6B2737, 0x27374D),
      .wood = kOak,
      .dark_wood = kWalnut,
      .fabric = pattern(PatternKind::kFabric, 0.6f, 0xB9A88A, 0xD8CBB2),
      .cushion = pattern(PatternKind::kFabric, 0.3f, 0x6B2737, 0xC8963E),
      .books = pattern(PatternKind::kBookSpines, 1, 0x27374D, 0x7F4F24, 0x588157),
      .paint = srgb_hex(0xF0EAD6),
      .ceramic = srgb_hex(0x7F9F5F),
      .pot = srgb_hex(0x27374D),
      .curtain = srgb_hex(0xC8963E),
      .walls = {
          WallProgram{.finish = paper, .furniture = {kMediaUnit, kFloorLamp}, .pictures = 3},
          {.finish = paper, .furniture = {kSofa, kPlant}, .pictures = 2},
          {.finish = paper, .furniture = {kStool}, .windows = 1, .doors = 1, .pictures = 1},
          {.finish = pattern(PatternKind::kPlanks, 1.6f, 0x8A5F3B, 0x5F3E25, 0x24160C),
           .furniture = {kWardrobe, kSideboard},
           .windows = 1,
           .pictures = 2}}};
}

}  // namespace

const std::vector<RoomProgram>& room_programs() {
  static const std::vector<RoomProgram> programs{
      living_room(), study(), loft(), gallery(), lounge()};
  return programs;
}

}  // namespace glint
