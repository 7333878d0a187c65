// SPDX-License-Identifier: MIT
// A triangle mesh as files, extraction and metrics exchange it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "glint/core/vec.h"

namespace glint {

using Triangle = std::array<std::int32_t, 3>;  // ids of vertices

struct TriangleMesh {
  std::vector<Vec3f> vertices;  // metres
  std::vector<Triangle> faces;
  std::vector<Vec3f> colors;  // per vertex, [0, 1]; may be empty
};

}  // namespace glint
