// SPDX-License-Identifier: MIT
// A lean build resizes nothing.
#include "glint/core/error.h"
#include "glint/scene/image_files.h"

namespace glint {

Image resize_image(ImageView image, ImageSize size) {
  throw Error(
      ExitCode::kEnvironment,
      fmt::format(
          "resizing {} x {} pixels to {} x {}: this lean build cannot; pack the scene at that size "
          "with the full build (glint-bench dataset pack --max-pixels)",
          image.width,
          image.height,
          size.width,
          size.height
      )
  );
}

}  // namespace glint
