// SPDX-License-Identifier: MIT
// Which code computes a stage of a run: the list that keys of results go by.
#pragma once

#include <string>
#include <vector>

namespace glint {

struct StageSources {
  std::string name;
  std::vector<std::string> patterns;  // globs below the project's folder; what they include counts
};

// "make" (GlassRooms; "front3d": rooms of 3D-FRONT) and "load" of data, "cuda" (what a GPU adds to
// training and rendering), "render", "mesh", "score". Besides, each file that registers a method or
// a loader is an entry under its own name.
const std::vector<StageSources>& stage_sources();

}  // namespace glint
