// SPDX-License-Identifier: MIT
// Maps that are right but for a convention: the words for what a score alone does not tell.
#pragma once

#include <span>
#include <string>

#include "glint/core/image.h"
#include "metrics/tools/pairing.h"

namespace glint {

// Both as metres. Empty: nothing is odd.
std::string depth_unit_doubt(ImageView prediction, ImageView reference);

// Both in OpenCV's axes of the camera; `found_axes` are those that the prediction was read in.
// Other axes of which less than half of the error is left: those of opengl or stablenormal, or one
// rotation of all, as of the world's axes. Empty: none.
std::string normal_axes_doubt(
    ImageView prediction, ImageView reference, const std::string& found_axes
);

// Predictions as JPEG, which lost what compression took. Empty: none.
std::string lossy_doubt(std::span<const FilePair> pairs);

}  // namespace glint
