// SPDX-License-Identifier: MIT
// GivenSurface, pixel by pixel.
#pragma once

#include "glint/core/kernel.h"
#include "glint/core/vec.h"

namespace glint {

struct PutSurface {
  int channels, transparency;             // features, and which of them is t
  const float *features, *depth, *glass;  // [H][W][channels], [H][W][1] each
  float *out, *alpha, *depth_sum;
  GLINT_HD void operator()(std::size_t i) const {
    const std::size_t first = i * static_cast<std::size_t>(channels);
    for (int c = 0; c < channels; ++c)
      out[first + c] = c == transparency ? glass[i] : features[first + c];
    alpha[i] = depth[i] > 0 ? 1.0f : 0.0f;
    depth_sum[i] = depth[i];
  }
};
// Of the features alone, without t.
struct PutSurfaceVjp {
  int channels, transparency;
  const float* dL_dout;
  float* dL_dfeatures;  // added to
  GLINT_HD void operator()(std::size_t i) const {
    const std::size_t first = i * static_cast<std::size_t>(channels);
    for (int c = 0; c < channels; ++c)
      if (c != transparency) dL_dfeatures[first + c] += dL_dout[first + c];
  }
};

using GivenSurfaceKernels = KernelList<PutSurface, PutSurfaceVjp>;

}  // namespace glint
