// SPDX-License-Identifier: MIT
// Pixels of a photo that count or do not (counted_pixels.h).
#pragma once

#include "glint/core/kernel.h"
#include "glint/core/vec.h"

namespace glint {

// The render where pixels count, else the photo.
struct PutPhoto {
  const float *counted, *rendered, *photo;
  float* picture;
  GLINT_HD void operator()(std::size_t i) const {
    put3(picture, i, get3(counted[i] != 0 ? rendered : photo, i));
  }
};
struct AddCounted {
  const float *counted, *gradient;
  float* sum;
  GLINT_HD void operator()(std::size_t i) const {
    if (counted[i] != 0) put3(sum, i, get3(sum, i) + get3(gradient, i));
  }
};
// A map of one channel, 0 where pixels do not count.
struct KeepCounted {
  const float* counted;
  float* map;
  GLINT_HD void operator()(std::size_t i) const {
    if (counted[i] == 0) map[i] = 0;
  }
};

using CountedKernels = KernelList<PutPhoto, AddCounted, KeepCounted>;

}  // namespace glint
