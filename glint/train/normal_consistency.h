// SPDX-License-Identifier: MIT
// Normal consistency [Huang24 Eq. 14]: mean over pixels of m (1 - N . (A N_d)), with N the
// composited normal (not normalised; its unit vector in [Zhang25]), N_d the normal of the surface
// depth, A the alpha map held constant, m = 1 or the factors of [Xie25]. `cosine`: the weighted
// mean of 1 - N/|N| . N_d instead, over the pixels that have N_d, as GLINT's second release.
#pragma once

#include "glint/train/depth_normal_loss.h"

namespace glint {

class NormalConsistencyLoss {
 public:
  bool unit_normals = false;  // N / |N|
  bool cosine = false;        // of unit normals, without A; divided by the sum of m

  // normal: [H][W][3] camera space; depth: [H][W][1] planar z, metres; alpha: [H][W][1];
  // pixel_weight: m, [H][W][1] or empty; the mean divides by the number of pixels. Adds
  // weight * gradient to dL_dnormal and dL_ddepth. Returns the unweighted loss. Pixels at the
  // border, or with a neighbour without depth, count as 1 and have no gradient.
  double evaluate(
      const Camera& camera,
      const Image& normal,
      const Image& depth,
      const Image& alpha,
      float weight,
      Image& dL_dnormal,
      Image& dL_ddepth,
      const Image& pixel_weight = {}
  );
  // Normals of a depth map, [H][W][3]; zero at the border and where a neighbour has no depth.
  static Image depth_normals(const Camera& camera, const Image& depth);

 private:
  // m of the weighted mean, whose mean over all pixels is 1.
  const Image& shares(const Camera& camera, const Image& depth, const Image& pixel_weight);

  Image ones_, shares_;
  Array<double> weight_sum_;  // [1]
  DepthNormalLoss<NormalConsistencyAt> loss_;
  DepthNormalLoss<UnitNormalConsistencyAt> of_units_;
};

}  // namespace glint
