// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "glint/core/kernel.h"
#include "glint/render/activations.h"
#include "glint/train/pixel_losses.h"

namespace glint {

// Surfels laid out in rows, to be summed one after the other in each.
struct SurfelRows {
  static constexpr int kRow = 256;
  std::size_t count;

  GLINT_HD static std::size_t at(int x, int y) {
    return static_cast<std::size_t>(y) * kRow + static_cast<std::size_t>(x);
  }
  ImageSize layout() const { return {kRow, static_cast<int>((count + kRow - 1) / kRow)}; }
};
// Which of them a view has.
struct SurfelsInView : SurfelRows {
  const std::uint8_t* in_view;  // [N]
  GLINT_HD bool has(int x, int y) const { return at(x, y) < count && in_view[at(x, y)] != 0; }
};

struct CountInView {
  SurfelsInView surfels;
  GLINT_HD double operator()(int x, int y) const { return surfels.has(x, y) ? 1 : 0; }
};

// What of an opacity is summed, and its slope.
struct OfOpacity {
  GLINT_HD static float value(float opacity) { return opacity; }
  GLINT_HD static void vjp(float, float dL_dvalue, float& dL_dopacity) { dL_dopacity += dL_dvalue; }
};
struct OfEntropy {
  GLINT_HD static float value(float opacity) { return binary_entropy(opacity); }
  GLINT_HD static void vjp(float opacity, float dL_dvalue, float& dL_dopacity) {
    binary_entropy_vjp(opacity, dL_dvalue, dL_dopacity);
  }
};

// Sum of it over the surfels in view, and the gradient of weight times its mean.
template <class Of>
struct PenaltyInView {
  SurfelsInView surfels;
  const float* logits;  // [N]
  const double* num_in_view;
  float weight;
  float* dL_dlogits;  // added to

  GLINT_HD double operator()(int x, int y) const {
    if (!surfels.has(x, y)) return 0;
    const std::size_t i = surfels.at(x, y);
    const float opacity = sigmoid(logits[i]);
    float dL_dopacity = 0;
    Of::vjp(opacity, weight / static_cast<float>(*num_in_view), dL_dopacity);
    dL_dlogits[i] += sigmoid_vjp(opacity, dL_dopacity);
    return static_cast<double>(Of::value(opacity));
  }
};

struct SumInRows : SurfelRows {
  const float* values;  // [N]
  GLINT_HD double operator()(int x, int y) const {
    return at(x, y) < count ? static_cast<double>(values[at(x, y)]) : 0;
  }
};
// sum v H(sigmoid(logit)) of an extra channel, v the surfel's weight in the picture, and the
// gradient of weight times its mean.
struct ChannelEntropy {
  SumInRows visibility;
  const float* logits;  // [N][width]
  std::size_t column, width;
  const double* sum;  // of the visibilities
  float weight;
  float* dL_dlogits;  // added to

  GLINT_HD double operator()(int x, int y) const {
    const std::size_t i = SurfelRows::at(x, y);
    if (i >= visibility.count || !(visibility.values[i] > 0)) return 0;
    const float v = visibility.values[i], p = sigmoid(logits[i * width + column]);
    float dL_dp = 0;
    binary_entropy_vjp(p, weight * v / static_cast<float>(*sum), dL_dp);
    dL_dlogits[i * width + column] += sigmoid_vjp(p, dL_dp);
    return static_cast<double>(v * binary_entropy(p));
  }
};

using OpacityPenaltyKernels = KernelList<
    CountInView,
    PenaltyInView<OfOpacity>,
    PenaltyInView<OfEntropy>,
    SumInRows,
    ChannelEntropy>;

}  // namespace glint
