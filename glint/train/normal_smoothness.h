// SPDX-License-Identifier: MIT
// Edge-aware smoothness of normals, which [Na26] names without a formula: mean over pixels of
// sum_e |n(p + e) - n(p)|_1 exp(-sharpness mean_c |I(p + e) - I(p)|), e = x, y, n = N/|N|.
#pragma once

#include "glint/core/image.h"

namespace glint {

struct NormalSmoothnessLoss {
  float edge_sharpness = 1;  // beta; 1: the release

  // normal: composited N [H][W][3]; image: [H][W][3] in [0, 1], the photograph. Differences with a
  // pixel without N count as 0. Adds weight * gradient to dL_dnormal (through the normalisation)
  // and returns the unweighted loss.
  template <class T>
  double evaluate(
      const BasicImage<T>& normal, const Image& image, T weight, BasicImage<T>& dL_dnormal
  ) const;
};

}  // namespace glint
