// SPDX-License-Identifier: MIT
// Single-view regularisation of planes [Chen24 Eq. 9]: mean over pixels of W |A N_D - N|_1, with N
// the composited normal, N_D that of the plane depth, A the alpha map held constant, and W small at
// the edges of the photo, where a pixel and its neighbours need not lie in one plane.
#pragma once

#include "glint/train/depth_normal_loss.h"

namespace glint {

// W = (1 - g)^2, [H][W][1]: g is the larger of the central differences of the photo along x and y
// (mean over channels of the absolute difference), brought to [0, 1] by its extremes in the image.
// 0 at the border; where the whole photo changes alike, 1.
Image flatness_weight(const Image& rgb);

class PlaneConsistencyLoss {
 public:
  // normal: [H][W][3] camera space; depth: [H][W][1] metres; alpha, flatness: [H][W][1]. Adds
  // weight * gradient to dL_dnormal and dL_ddepth. Returns the unweighted loss. Pixels at the
  // border, or with a neighbour without depth, count as 0.
  double evaluate(
      const Camera& camera,
      const Image& normal,
      const Image& depth,
      const Image& alpha,
      const Image& flatness,
      float weight,
      Image& dL_dnormal,
      Image& dL_ddepth
  );

 private:
  DepthNormalLoss<PlaneConsistencyAt> loss_;
};

}  // namespace glint
