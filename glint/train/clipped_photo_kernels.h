// SPDX-License-Identifier: MIT
// Renders that are brighter than a photo can say (clipped_photo.h), value by value.
#pragma once

#include "glint/core/kernel.h"
#include "glint/core/vec.h"

namespace glint {

struct ClipToPhoto {
  float white;
  const float *rendered, *photo;
  float* clipped;
  GLINT_HD void operator()(std::size_t i) const {
    const bool is_white = photo[i] >= white;
    clipped[i] = is_white ? min_of(rendered[i], photo[i]) : rendered[i];
  }
};
struct ClipToPhotoVjp {
  float white;
  const float *rendered, *photo;
  float* gradient;
  GLINT_HD void operator()(std::size_t i) const {
    if (photo[i] >= white && rendered[i] > photo[i]) gradient[i] = 0;
  }
};

using ClippedPhotoKernels = KernelList<ClipToPhoto, ClipToPhotoVjp>;

}  // namespace glint
