// SPDX-License-Identifier: MIT
// What all metrics share: a result per image with its protocol, and the regions it is given for.
#pragma once

#include <string>
#include <vector>

#include "glint/core/config.h"
#include "glint/core/image.h"

namespace glint {

// Pixels that count. An empty mask means all.
bool counts(MaskView mask, int x, int y);

// Region masks from the ground-truth glass mask: "glass", "glass-border" (3 px to either side of the
// outline), "opaque" (not glass). Each has the size of `glass`.
MaskImage glass_region(MaskView glass);
MaskImage glass_border_region(MaskView glass, int radius_px = 3);
MaskImage opaque_region(MaskView glass);

}  // namespace glint
