// SPDX-License-Identifier: MIT
// Loops of glint/train/exposure.h.
#pragma once

#include "glint/core/image.h"
#include "glint/core/kernel.h"

namespace glint {

// gain I + offset; element i: a value.
struct Expose {
  const float* rendered;
  float gain, offset;
  float* exposed;
  GLINT_HD void operator()(std::size_t i) const { exposed[i] = gain * rendered[i] + offset; }
};

struct ExposureGradient {
  double gain = 0, offset = 0;
  GLINT_HD ExposureGradient& operator+=(const ExposureGradient& o) {
    gain += o.gain;
    offset += o.offset;
    return *this;
  }
};
struct ExposeVjp {
  ImageView rendered, dL_dexposed;  // [H][W][3]
  float gain;
  ImageRef dL_drendered;  // added to
  GLINT_HD ExposureGradient operator()(int x, int y) const {
    ExposureGradient sum;
    for (int c = 0; c < 3; ++c) {
      const float g = dL_dexposed.at(x, y, c);
      dL_drendered.at(x, y, c) += gain * g;
      sum.gain += static_cast<double>(g * rendered.at(x, y, c));
      sum.offset += static_cast<double>(g);
    }
    return sum;
  }
};

using ExposureKernels = KernelList<Expose, ExposeVjp>;

}  // namespace glint
