// SPDX-License-Identifier: MIT
// Photos are clipped: where one is white, a picture that is brighter is no error, and radiance
// above white is learned from where it is mirrored. Beyond the paper.
#pragma once

#include "glint/core/kernel.h"

namespace glint {

inline constexpr float kWhite = 0.995f;  // of a photo's channel, 8 bits: 254 and 255

// target: what the picture is held to; the photo, or what is left of it.
struct ClipAtWhite {
  const float *image, *photo, *target;  // [H][W][3]
  float* clipped;
  GLINT_HD void operator()(std::size_t i) const {
    const bool no_error = photo[i] >= kWhite && image[i] > target[i];
    clipped[i] = no_error ? target[i] : image[i];
  }
};
struct ClipAtWhiteVjp {
  const float *image, *photo, *target;
  float* gradient;
  GLINT_HD void operator()(std::size_t i) const {
    if (photo[i] >= kWhite && image[i] > target[i]) gradient[i] = 0;
  }
};

using ClipAtWhiteKernels = KernelList<ClipAtWhite, ClipAtWhiteVjp>;

}  // namespace glint
