// SPDX-License-Identifier: MIT
// Photometric loss of one view: (1 - w) L1 + w (1 - SSIM), value and gradient in one pass.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "glint/train/counted_pixels.h"

namespace glint {

struct PhotometricWeights {
  float l1 = 0.8f;
  float ssim = 0.2f;
};

struct PhotometricTerms {
  double l1 = 0;         // mean absolute error over pixels and channels
  double ssim_loss = 0;  // 1 - mean SSIM (11x11 Gaussian, zero padding)
  double mse = 0;        // of the render clamped to [0, 1], over the pixels that count
  double weighted(PhotometricWeights w) const {
    return static_cast<double>(w.l1) * l1 + static_cast<double>(w.ssim) * ssim_loss;
  }
  double psnr() const { return -10 * std::log10(std::max(mse, 1e-10)); }  // dB, at most 100
};

// Keeps its buffers between calls: no allocation in steady state.
class PhotometricLoss {
 public:
  // rendered: [H][W][3], as the photo. Adds weight * dL/d(rendered) to `gradient` (same shape).
  // Where a pixel does not count it is right; means are over all pixels, but for that of the PSNR.
  PhotometricTerms evaluate(
      const Image& rendered, const Photo& photo, PhotometricWeights weights, Image& gradient
  );

 private:
  PhotometricTerms evaluate_all(
      const Image& rendered, const Image& target, PhotometricWeights weights, Image& gradient
  );
  PhotometricTerms evaluate_on_gpu(
      const Image& rendered, const Image& target, PhotometricWeights weights, Image& gradient
  );
  void blur_rows(const Image& rendered, const Image& target, int channel);
  void ssim_rows();
  void gradient_rows(
      const Image& rendered,
      const Image& target,
      int channel,
      PhotometricWeights weights,
      Image& gradient
  );
  float* plane_row(FloatArray& planes, int plane, int y);

  int width_ = 0, height_ = 0;
  std::size_t stride_ = 0;       // floats a row of a plane, a multiple of 8
  FloatArray moments_;           // [5][H][stride] horizontally blurred x, y, xx, yy, xy
  FloatArray moment_gradients_;  // [3][H][stride] of x, xx, xy
  std::vector<double> row_ssim_, row_l1_, row_mse_;  // [H] sums, added in order
  CountedPixels counted_;
};

}  // namespace glint
