// SPDX-License-Identifier: MIT
// A room of a house as GlassRoom's rooms are: surfaces with finishes, furniture, ceiling lights,
// and what closes it. Its frame: the middle of the floor's box is the origin, the floor is z = 0.
#pragma once

#include <string>
#include <vector>

#include "datasets/front3d/floor_plan.h"
#include "datasets/front3d/house.h"
#include "datasets/glassroom/room.h"

namespace glint {

struct HousePiece {
  std::string category, jid;
  bool has_model = false;  // else a box of the right size
  Pose pose;               // x_room = rotation (scale * x_model) + translation, all with z up
  Vec3f scale{1, 1, 1};
  Bounds bounds;  // in the room's frame
};

struct FurnishedRoom {
  RoomModel room;  // the container has no place yet
  FloorPlan plan;  // furniture is taken away from it
  Vec3f origin{};  // x_room = x_house - origin
  std::vector<HousePiece> pieces;
  std::vector<std::string> notes;  // what was left out, a line each
};

struct HouseRoomOptions {
  fs::path models, textures;  // folders, or empty
  std::uint64_t seed = 0;     // draws the finishes
};

// The room's own meshes, doors and windows of others that touch it, and the furniture that stands
// in it. Behind windows lie panels that glow; slabs close the room on all sides, so that no ray
// leaves it. `where` opens messages. Errors (kBadReference): the floor's (FloorPlan), walls lower
// than 2 m or higher than 20 m, more surface than 50,000 m^2; those of models and textures.
FurnishedRoom furnish_house_room(
    const House& house,
    const HouseRoom& room,
    const HouseRoomOptions& options,
    const std::string& where
);

}  // namespace glint
