// SPDX-License-Identifier: MIT
// Places along the Z-order curve.
#pragma once

#include <cstdint>

#include "glint/core/vec.h"

namespace glint {

inline constexpr int kMortonBits = 21;  // an axis

// Bits of a 21-bit number two places apart.
GLINT_HD std::uint64_t spread_bits(std::uint64_t v) {
  v = (v | v << 32) & 0x001f00000000ffffull;
  v = (v | v << 16) & 0x001f0000ff0000ffull;
  v = (v | v << 8) & 0x100f00f00f00f00full;
  v = (v | v << 4) & 0x10c30c30c30c30c3ull;
  return (v | v << 2) & 0x1249249249249249ull;
}

GLINT_HD float widest(Vec3f size) { return max_of(max_of(size.x, max_of(size.y, size.z)), 1e-30f); }

// Of the (2^21)^3 cells of a cube around a box, the place of the one that holds `point`. Cells are
// cubes, too, so that one point far away makes them larger but not longer: in a box of 1000 m
// they are half a millimetre wide.
GLINT_HD std::uint64_t morton_code(Vec3f point, Vec3f low, Vec3f high) {
  constexpr float kCells = 1 << kMortonBits;
  const float width = widest(high - low);
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float cell = min_of(kCells - 1, kCells * ((point[axis] - low[axis]) / width));
    code |= spread_bits(static_cast<std::uint64_t>(max_of(0.0f, cell))) << axis;
  }
  return code;
}

}  // namespace glint
