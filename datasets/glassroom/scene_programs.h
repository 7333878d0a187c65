// SPDX-License-Identifier: MIT
// What each scene of GlassRoom consists of: a room, and what of glass there is in it beyond a case.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "datasets/glassroom/container.h"
#include "datasets/glassroom/room_programs.h"

namespace glint {

struct SceneProgram {
  RoomProgram room;                           // its name is the scene's
  bool nested = false;                        // a smaller case in the case
  std::optional<std::array<Vec3f, 6>> tints;  // of the case's panes
  double min_glass = 0.15, max_glass = 0.40;  // mean share of glass in the images
  double max_radius = 2.3;                    // of the cameras, metres from the case's axis
};

// Errors (kUsage): no such scene; the known ones are listed.
const SceneProgram& scene_program(std::string_view name);
// The five rooms, then those beyond first order.
const std::vector<SceneProgram>& scene_programs();

}  // namespace glint
