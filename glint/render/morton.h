// SPDX-License-Identifier: MIT
// Places along the Z-order curve.
#pragma once

#include <cstdint>

#include "glint/core/vec.h"

namespace glint {

// Bits of a 10-bit number two places apart.
GLINT_HD std::uint32_t spread_bits(std::uint32_t v) {
  v = (v | v << 16) & 0x030000ffu;
  v = (v | v << 8) & 0x0300f00fu;
  v = (v | v << 4) & 0x030c30c3u;
  return (v | v << 2) & 0x09249249u;
}

// Of the 1024^3 cells of a box, the place of the one that holds `point`.
GLINT_HD std::uint32_t morton_code(Vec3f point, Vec3f low, Vec3f high) {
  std::uint32_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float width = max_of(high[axis] - low[axis], 1e-30f);
    const float cell = min_of(1023.0f, 1024 * ((point[axis] - low[axis]) / width));
    code |= spread_bits(static_cast<std::uint32_t>(max_of(0.0f, cell))) << axis;
  }
  return code;
}

}  // namespace glint
