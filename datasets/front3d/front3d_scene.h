// SPDX-License-Identifier: MIT
// The 3D scene of a room of 3D-FRONT before rendering.
#pragma once

#include <memory>

#include "datasets/front3d/front3d.h"
#include "datasets/front3d/house_room.h"
#include "datasets/glassroom/glassroom_scene.h"

namespace glint {

// What a house's file says, and the room that the options mean.
struct ChosenRoom {
  House house;
  HouseRoom room;
  std::string where;  // opens messages: the file and the room
};
ChosenRoom choose_front3d_room(const Front3dOptions& options);

// The layout is drawn from the seed until the container settles and cameras see it, as in
// build_layout(). `furnished`: what furnish_house_room() made of the room. Errors (kBadReference):
// no free place; those of build_layout().
std::unique_ptr<GlassRoomScene> build_front3d_scene(
    const FurnishedRoom& furnished, const ChosenRoom& chosen, const Front3dOptions& options
);

// What its pictures are drawn from.
std::uint64_t front3d_render_seed(const ChosenRoom& chosen, const Front3dOptions& options);

FurnishedRoom furnish_front3d_room(const ChosenRoom& chosen, const Front3dOptions& options);

}  // namespace glint
