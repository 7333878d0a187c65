// SPDX-License-Identifier: MIT
// Maps as colours, for people. Depth is viridis from near (yellow) to far (violet); shares in
// [0, 1], such as t and k_s, are viridis upwards; errors, angles and distances are magma. Both get
// lighter evenly, in grey print and to colour-blind readers too.
#pragma once

#include <array>

#include "glint/core/image.h"

namespace glint {

// Red, green, blue of 256 entries from dark to light, in millionths.
using ColorTable = std::array<int, 3 * 256>;
extern const ColorTable kViridis, kMagma;

// Depth over [low, high]: light is near. Black where there is nothing (0, not finite).
Image colorize_depth(ImageView depth, float low, float high);
// n * 0.5 + 0.5 with y, z turned towards the viewer (the field's habit). Black: nothing.
Image colorize_normal(ImageView normal);
// Black at 0, white at 1.
Image grey_picture(ImageView map);
// Other maps, dark (low) to light (high); mid-grey where not finite.
enum class ScalarColors { kViridis, kMagma };
Image colorize_scalar(ImageView map, float low, float high, ScalarColors colors);
}  // namespace glint
