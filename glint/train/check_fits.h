// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

#include "glint/core/error.h"
#include "glint/core/image.h"

namespace glint {

// Throws unless the image has the map's size and as many channels as expected.
template <class Image>
void check_fits(
    std::string_view name, const Image& image, ImageSize expected, int expected_channels
) {
  GLINT_CHECK(
      image.size() == expected && image.channels() == expected_channels,
      kBadReference,
      "{}: {}x{} pixels with {} channels found, {}x{} with {} expected, as the rendered map; "
      "resize it to its view's image",
      name,
      image.size().width,
      image.size().height,
      image.channels(),
      expected.width,
      expected.height,
      expected_channels
  );
}

}  // namespace glint
