// SPDX-License-Identifier: MIT
// Regulariser of the transparency map t, in GLINT's release and not in the paper: mean binary
// entropy of t, mean |t|, and edge-aware smoothness of t.
#pragma once

#include "glint/core/image.h"

namespace glint {

struct TransparencyPriorLoss {
  float entropy = 1, sparsity = 1, smoothness = 1;  // weights of the three terms
  float edge_sharpness = 1;                         // of the smoothness, as NormalSmoothnessLoss

  // transparency: t [H][W][1] in [0, 1]; image: [H][W][3] in [0, 1], the photograph. The entropy
  // has no gradient where t is within 1e-6 of 0 or 1. Adds weight * gradient to dL_dtransparency
  // and returns the unweighted loss.
  template <class T>
  double evaluate(
      const BasicImage<T>& transparency,
      const Image& image,
      T weight,
      BasicImage<T>& dL_dtransparency
  ) const;
};

}  // namespace glint
