// SPDX-License-Identifier: MIT
// Scale-and-shift-invariant depth loss [Yu22; Na26 supplement]: mean over valid pixels of
// (w z + q - prior)^2 with (w, q) the least-squares fit of the rendered depth z to the prior, in
// closed form for each image. Optionally the gradient-matching term of [Yu22] and GLINT's release.
#pragma once

#include "glint/core/image.h"

namespace glint {

// prior ~ scale depth + shift, and what its derivative needs.
struct DepthPriorFit {
  bool valid = false;  // false: fewer than two valid pixels, or one depth at all of them
  double scale = 0, shift = 0;
  double weight_sum = 0;                  // M = sum m, the number of valid pixels without weights
  double mean_depth = 0, mean_prior = 0;  // weighted by m
  double depth_variation = 0;             // sum m (z - mean_depth)^2
};
// Valid pixels: depth > 0, prior > 0, m > 0. pixel_weight: m, [H][W][1], empty for 1.
template <class T>
DepthPriorFit fit_depth_prior(
    const BasicImage<T>& depth, const Image& prior, const Image& pixel_weight
);

// L = sum m r^2 / M + gradient_weight sum_s (sum_pairs m m' |r' - r|) / M_s, r = w z + q - prior.
// Pairs at scale s are neighbours in x and y of the image that keeps every 2^s-th pixel; M_s is
// that image's sum of m.
//
// The gradient includes that (w, q) depend on z. The first term is minimal in (w, q), so by the
// envelope theorem they add nothing to dL/dz_i = 2 w m_i r_i / M. The second term does not depend
// on q; its dependence on w is followed through w = sum m (z - mean)(prior - mean) / sum m (z -
// mean)^2.
struct DepthPriorLoss {
  int gradient_scales = 0;  // 0: the paper; 4 (strides 1, 2, 4, 8): the release
  // The release halves both terms, so that its weight lambda is lambda / 2 here.
  // Deviation: in the release the rows are one line, so that y is never matched and x wraps around.
  float gradient_weight = 1;

  // depth: rendered planar z [H][W][1], metres; prior: [H][W][1], any affine unit, larger =
  // farther; pixel_weight: m, [H][W][1] or empty. Adds weight * gradient to dL_ddepth and returns
  // the unweighted loss; an empty prior or a fit that is not valid gives 0 and no gradient.
  template <class T>
  double evaluate(
      const BasicImage<T>& depth,
      const Image& prior,
      const Image& pixel_weight,
      T weight,
      BasicImage<T>& dL_ddepth
  ) const;
};

}  // namespace glint
