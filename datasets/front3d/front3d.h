// SPDX-License-Identifier: MIT
// Rooms of 3D-FRONT with a glass container, after the paper's description of 3D-FRONT-T, rendered
// by our path tracer. They are never called 3D-FRONT-T: that is the authors' data. One call writes
// a whole scene folder in GlassRoom's layout.
#pragma once

#include <cstdint>
#include <string>

#include "datasets/glassroom/prior_levels.h"
#include "glint/core/files.h"
#include "glint/core/service.h"

namespace glint {

struct Front3dOptions {
  std::string house;             // JSON file of 3D-FRONT
  std::string room;              // instanceid; empty: the room with the largest floor
  std::string models;            // folder with 3D-FUTURE's models; empty: boxes
  std::string textures;          // folder with pictures; empty: patterns
  int width = 160, height = 90;  // pixels
  int views = 64;                // along the camera path; every 8th is a test view
  int spp = 64;                  // samples a pixel of a training view, a quarter of a test view's
  std::uint64_t seed = 0;        // draws finishes, the container and its place
  std::string priors = kDefaultPriorLevel;
};

inline constexpr const char* kFront3dElsewhere =
    "make and pack the scene with the full build (glint-bench dataset make, dataset pack)";

// Name of the scene: the house's file and the room. Errors: those of read_house, choose_room.
inline constinit Service<std::string(const Front3dOptions&)> front3d_name{
    "naming a room of 3D-FRONT", kFront3dElsewhere};

// Hash of the options, of what the files hold that they name, and of the generator's version: the
// cache key, written to scene.json.
inline constinit Service<std::string(const Front3dOptions&)> front3d_hash{
    "the version of a room of 3D-FRONT", kFront3dElsewhere};

// As make_glassroom(). Errors (kBadReference): the house, models or pictures cannot be used, or the
// room has no free place for a container; (kUsage): no such room, sizes out of range;
// (kEnvironment): no layout worked.
inline constinit Service<bool(const Front3dOptions& options, const fs::path& folder, bool again)>
    make_front3d{"making a room of 3D-FRONT", kFront3dElsewhere};

}  // namespace glint
