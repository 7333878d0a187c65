// SPDX-License-Identifier: MIT
// Normal prior [Na26 supplement]: mean over the pixels with a prior of M (1 - <n, prior>), n =
// N/|N| of the composited normal, M = [<n, prior> >= tau] a constant gate against noisy priors.
#pragma once

#include "glint/core/image.h"

namespace glint {

struct NormalPriorLoss {
  static constexpr float kNoGate = -2;  // below every cosine
  // tau. Paper: no gate before iteration 10,000, then 0.3. Release: then 0.5.
  // A gated pixel counts as 0; in the release it counts as 1 without gradient, which is a mistake
  // of the logged value only and is not copied.
  float min_cosine = kNoGate;
  float l1 = 0;  // of |n - prior|_1 beside 1 - <n, prior> [Xie25: 1], behind the same gate
  // The mean divides by the sum of the weights of the pixels with a prior: masks rather than
  // doubts.
  bool weighted_mean = false;

  // normal: composited N [H][W][3], camera space; prior: [H][W][3] unit, camera space, zero where
  // missing; pixel_weight: [H][W][1] factors, or empty for 1. The mean divides by the number of
  // pixels with a prior, if not weighted_mean. A pixel without N counts as cosine 0 and
  // has no gradient. Adds weight * gradient to dL_dnormal and returns the unweighted loss; without
  // any prior, 0. Deviation: the paper writes a sum, whose weight would depend on the resolution.
  template <class T>
  double evaluate(
      const BasicImage<T>& normal,
      const Image& prior,
      const Image& pixel_weight,
      T weight,
      BasicImage<T>& dL_dnormal
  ) const;
};

// The release's weight of a pixel, a constant: 1 - clip((z - near) / (far - near), 0, 1), with 1 %
// of the depths nearer than near and 1 % farther than far. depth: planar z [H][W][1]. 0 where there
// is no depth, 1 at every other pixel of a depth map that is constant.
Image inverse_depth_weight(const Image& depth);

}  // namespace glint
