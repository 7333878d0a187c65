// SPDX-License-Identifier: MIT
// A rendered picture with more or less of what the glass mirrors and lets through, from the maps
// that a method renders anyway.
#pragma once

#include <string>
#include <vector>

#include "glint/scene/maps.h"
#include "reports/show/pictures/layers.h"

namespace glint {

// Factors of k_s, of the light behind the glass, and of t; 1: as it is. With k_s at 0 the picture
// keeps its brightness: nothing is mirrored, all else shines through.
struct LightScales {
  float reflection = 1, transmission = 1, transparency = 1;

  friend bool operator==(const LightScales&, const LightScales&) = default;
};

// Fields of LightScales that change something in these maps.
std::vector<std::string> scales_of(const MapSet& maps);

// [H][W][3]. With all of its layers the picture changes by the difference that Eq. 5-10 makes;
// with parts of the picture alone ("transmitted", "reflected"), by their factors.
Image with_scales(const MapSet& maps, const LightScales& scales);

// [H][W][3]: what is behind the glass where it is (t > 0.5), without what it mirrors; the picture
// elsewhere. Empty: the maps do not tell.
Image without_glass(const MapSet& maps);
// How that is shown; its id is that of no map.
PageLayer layer_without_glass();

}  // namespace glint
