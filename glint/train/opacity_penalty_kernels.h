// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "glint/core/kernel.h"
#include "glint/render/activations.h"

namespace glint {

// Surfels laid out in rows, and which of them a view has.
struct SurfelsInView {
  const std::uint8_t* in_view;  // [N]
  std::size_t count;
  int row;  // surfels a row

  GLINT_HD std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(row) +
           static_cast<std::size_t>(x);
  }
  GLINT_HD bool has(int x, int y) const { return at(x, y) < count && in_view[at(x, y)] != 0; }
};

struct CountInView {
  SurfelsInView surfels;
  GLINT_HD double operator()(int x, int y) const { return surfels.has(x, y) ? 1 : 0; }
};

// Sum of the opacities in view, and the gradient of weight times their mean.
struct OpacityPenalty {
  SurfelsInView surfels;
  const float* logits;  // [N]
  const double* num_in_view;
  float weight;
  float* dL_dlogits;  // added to

  GLINT_HD double operator()(int x, int y) const {
    if (!surfels.has(x, y)) return 0;
    const std::size_t i = surfels.at(x, y);
    const float opacity = sigmoid(logits[i]);
    dL_dlogits[i] += sigmoid_vjp(opacity, weight / static_cast<float>(*num_in_view));
    return static_cast<double>(opacity);
  }
};

// The same of the binary entropy -o log o - (1 - o) log(1 - o), whose slope in the logit x is
// -x o (1 - o).
struct OpacityEntropy {
  SurfelsInView surfels;
  const float* logits;  // [N]
  const double* num_in_view;
  float weight;
  float* dL_dlogits;  // added to

  GLINT_HD double operator()(int x, int y) const {
    if (!surfels.has(x, y)) return 0;
    const std::size_t i = surfels.at(x, y);
    const float logit = logits[i], opacity = sigmoid(logit);
    dL_dlogits[i] -= weight / static_cast<float>(*num_in_view) * logit * opacity * (1 - opacity);
    // softplus(x) - o x, which is finite where o is 0 or 1.
    const double l = static_cast<double>(logit);
    const double softplus = (l > 0 ? l : 0) + log1p(exp(l > 0 ? -l : l));
    return softplus - static_cast<double>(opacity) * l;
  }
};

using OpacityPenaltyKernels = KernelList<CountInView, OpacityPenalty, OpacityEntropy>;

}  // namespace glint
