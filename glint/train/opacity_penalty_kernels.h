// SPDX-License-Identifier: MIT
#pragma once

#include "glint/core/kernel.h"
#include "glint/render/activations.h"

namespace glint {

// Sum of opacities over surfels laid out in rows, and the gradient of weight times it.
struct OpacityPenalty {
  const float* logits;  // [N]
  std::size_t count;
  int row;  // surfels a row
  float weight;
  float* dL_dlogits;  // added to

  GLINT_HD double operator()(int x, int y) const {
    const auto i =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(row) + static_cast<std::size_t>(x);
    if (i >= count) return 0;
    const float opacity = sigmoid(logits[i]);
    dL_dlogits[i] += sigmoid_vjp(opacity, weight);
    return static_cast<double>(opacity);
  }
};

using OpacityPenaltyKernels = KernelList<OpacityPenalty>;

}  // namespace glint
