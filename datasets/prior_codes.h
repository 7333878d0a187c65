// SPDX-License-Identifier: MIT
// What the 8-bit samples of prior files stand for: one text for the loaders and for packed scenes,
// which keep the samples.
#pragma once

#include <array>
#include <cstdint>

#include "glint/core/vec.h"

namespace glint {

// To unit length; what is shorter than half of it is nothing: mid-grey decodes to about zero.
inline Vec3f unit_normal(Vec3f n) {
  constexpr float kMissing = 0.5f;
  const float norm = length(n);
  if (norm < kMissing) return {};
  return {n.x / norm, n.y / norm, n.z / norm};
}

// (n + 1) / 2 in [0, 1] -> n of unit length.
inline Vec3f decode_normal(Vec3f stored) {
  return unit_normal({2 * stored.x - 1, 2 * stored.y - 1, 2 * stored.z - 1});
}

// Depth in the bytes of a colour, the first the highest; each in [0, 1].
inline float decode_depth(float first, float second, float third) {
  return first + second / 256 + third / 65536;
}

}  // namespace glint
