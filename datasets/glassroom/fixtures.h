// SPDX-License-Identifier: MIT
// What is fixed to walls and ceiling: windows that glow, doors, pictures, mirrors, lights; and a
// shop window. Local frame of a wall as in furniture.h: the wall is the plane y = 0, y points into
// the room, the floor is z = 0.
#pragma once

#include <array>

#include "datasets/glassroom/furniture.h"

namespace glint {

inline constexpr int kWindowRows = 4;

// Radiance in arbitrary units; the exposure is fitted to the finished room.
inline constexpr Vec3f kCeilingLight{10.0f, 9.4f, 8.4f};
inline constexpr std::array<Vec3f, kWindowRows> kWindowLight{
    {{0.9f, 1.3f, 0.6f}, {1.2f, 1.7f, 1.1f}, {3.2f, 3.5f, 3.7f}, {3.0f, 3.9f, 5.0f}}};

// Materials that only fixtures use.
struct FixturePalette {
  std::array<int, kWindowRows> window_rows{};  // emitters from the sill up
  Finish curtain;
  int ceiling_light = 0;  // emitter
};

// Glowing panes in rows (garden, trees, haze, sky), mullions, a sill, curtains at both sides.
Furniture make_window(const Palette& palette, const FixturePalette& fixtures, Rng& rng);
Furniture make_door(const Palette& palette);
// Canvas with texture coordinates over [0, 1]^2, v up, u to the right as seen from the room.
Furniture make_picture(const Palette& palette, int canvas, float half_width, float half_height);
// A mirror that hangs from z = low to z = high, with a frame around it.
Furniture make_mirror(const Palette& palette, int mirror, float half_width, float low, float high);
// A pane of `glass` (one layer, in the plane y = 0) in a frame that stands on the floor.
inline constexpr float kShopWindowBeam = 0.05f;  // of its frame, metres
Furniture make_shop_window(const Palette& palette, int glass, float half_width, float height);
// Panel of the given half size that shines down from just under the ceiling, in a frame; centred at
// the origin of the ceiling plane z = 0.
Furniture make_ceiling_light(const Palette& palette, const FixturePalette& fixtures, float half);

}  // namespace glint
