// SPDX-License-Identifier: MIT
// Procedural furniture. Local frame: the back stands in the plane y = 0 (the wall), x runs along
// the wall and is centred, y points into the room, the floor is z = 0. Sizes vary with the random
// numbers.
#pragma once

#include <string_view>
#include <vector>

#include "datasets/glassroom/shapes.h"
#include "glint/core/rng.h"

namespace glint {

// A material of the scene and how many texture periods it repeats a metre.
struct Finish {
  int material = 0;
  float periods_per_metre = 1;
};

struct Palette {
  Finish wood, dark_wood, paint, fabric, cushion, metal, brass, black, ceramic, leaf, pot, books,
      shade;
};

struct FurniturePart {
  TraceMesh mesh;
  int material = 0;
};
using Furniture = std::vector<FurniturePart>;

enum class FurnitureKind {
  kSofa,
  kArmchair,
  kBookshelf,
  kSideboard,
  kWardrobe,
  kDesk,
  kMediaUnit,
  kPlant,
  kFloorLamp,
  kStool,
};

std::string_view furniture_name(FurnitureKind kind);
Furniture make_furniture(FurnitureKind kind, const Palette& palette, Rng& rng);
Bounds bounds_of(const Furniture& furniture);

}  // namespace glint
