// SPDX-License-Identifier: MIT
// Values behind the pictures, for the page's pixel probe.
#pragma once

#include "glint/core/config.h"
#include "reports/show/pictures/layers.h"

namespace glint {

// Larger views keep every second, third, ... pixel of a row and column, so that one map stays below
// this many.
inline constexpr std::size_t kProbePixels = 250'000;
int probe_step(ImageSize size);

// Per layer that the probe shows (rgb, depths, angle, shares): {"bits", "high", "data"}.
// Value = high x code / (2^bits - 1); of 16 bits, code 0 stands for "none" and data holds all low
// bytes, then all high bytes. Channels interleaved, rows from the top.
Json probe_values(const LayerMaps& maps, int step);

// The glass mask, one byte a pixel at full size, packed. Null: no mask.
Json probe_glass(const MaskImage& glass);

}  // namespace glint
