// SPDX-License-Identifier: MIT
// Photos are clipped: where one is white, a picture that is brighter is no error, and radiance
// above white is learned from where it is mirrored. Beyond the paper.
#pragma once

#include "glint/core/kernel.h"

namespace glint {

inline constexpr float kWhite = 0.995f;  // of a photo's channel, 8 bits: 254 and 255

// Of a channel of a pixel. target: what the picture is held to; the photo, or what is left of it.
GLINT_HD bool is_beyond_white(float image, float photo, float target) {
  return photo >= kWhite && image > target;
}

struct ClipAtWhite {
  const float *image, *photo, *target;  // [H][W][3]
  float* clipped;
  GLINT_HD void operator()(std::size_t i) const {
    clipped[i] = is_beyond_white(image[i], photo[i], target[i]) ? target[i] : image[i];
  }
};
struct ClipAtWhiteVjp {
  const float *image, *photo, *target;
  float* gradient;
  GLINT_HD void operator()(std::size_t i) const {
    if (is_beyond_white(image[i], photo[i], target[i])) gradient[i] = 0;
  }
};

using ClipAtWhiteKernels = KernelList<ClipAtWhite, ClipAtWhiteVjp>;

}  // namespace glint
