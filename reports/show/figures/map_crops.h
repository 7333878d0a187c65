// SPDX-License-Identifier: MIT
// Windows of a picture that are worth a closer look, the same for all methods.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "glint/core/image.h"

namespace glint {

struct Crop {
  int left = 0, top = 0, width = 0, height = 0;
  std::array<float, 3> color{};  // of its outline
};

inline constexpr std::size_t kMaxCrops = 3;  // of one picture

// "x,y,width,height" of a window in pixels, `index` chooses its colour. Errors (kUsage): not four
// whole numbers, an empty window, kMaxCrops or more before it.
Crop parse_crop(const std::string& text, std::size_t index);

// The window of a quarter of the width and height with the largest sum of `errors` ([H][W][1] of
// each method, of one size) over the pixels on glass, or over the others. `glass` empty: there is
// none. Nothing: no such pixel, no errors.
std::optional<Crop> crop_of_errors(
    const std::vector<const Image*>& errors, const MaskImage& glass, bool on_glass
);

// On glass (orange), off glass (blue): those that there are.
std::vector<Crop> choose_crops(const std::vector<const Image*>& errors, const MaskImage& glass);

// fit_panel() of the picture with the crops outlined; empty: an empty picture.
Image outlined(const Image& picture, const std::vector<Crop>& crops);

// The crops side by side, each framed in its colour, together as wide as outlined().
Image crop_panel(const Image& picture, const std::vector<Crop>& crops);

}  // namespace glint
