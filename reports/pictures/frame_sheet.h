// SPDX-License-Identifier: MIT
// The layers of one frame of a camera path on one picture, for videos.
#pragma once

#include <string>
#include <vector>

#include "glint/core/image.h"
#include "glint/core/service.h"

namespace glint {

struct TitledPicture {
  std::string title;
  Image picture;  // [H][W][1 or 3] as displayed; all of one size
};

// In rows, each with its title above, as near to 16:9 as they come; small pictures are enlarged
// (fit_panel). Even width and height, as video codecs want them.
inline constinit Service<Image(const std::vector<TitledPicture>& pictures)> frame_sheet{
    "drawing layers side by side", "use the full build"};

}  // namespace glint
