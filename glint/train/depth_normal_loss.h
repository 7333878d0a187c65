// SPDX-License-Identifier: MIT
// What losses between composited normals and the normals of a depth map share: `At`, of
// normal_kernels.h, is the loss at a pixel and its gradient to the normal and to the central
// differences of the depth's points; from those the gradient goes to the depths.
#pragma once

#include "glint/train/normal_kernels.h"

namespace glint {

template <class At>
class DepthNormalLoss {
 public:
  // Shapes as in normal_consistency.h; pixel_factor: what At multiplies a pixel by. Adds weight *
  // gradient; returns the mean over the pixels.
  double evaluate(
      const Camera& camera,
      const Image& normal,
      const Image& depth,
      const Image& alpha,
      const Image& pixel_factor,
      float weight,
      Image& dL_dnormal,
      Image& dL_ddepth
  ) {
    const Unprojector unproject = unprojector(camera, depth.on_device());
    fit(dL_dx_, depth.size(), 3);
    fit(dL_dy_, depth.size(), 3);
    const At loss_at{
        unproject,
        normal.on_device(),
        alpha.on_device(),
        pixel_factor.on_device(),
        weight / static_cast<float>(depth.num_pixels()),
        dL_dnormal.on_device(),
        dL_dx_.on_device(),
        dL_dy_.on_device()};
    const double sum = sum_kernel(depth.size(), loss_at);
    run_kernel(
        depth.num_pixels(),
        kGrain,
        ConsistencyDepthVjp{
            unproject, dL_dx_.on_device(), dL_dy_.on_device(), dL_ddepth.on_device()}
    );
    return sum / static_cast<double>(depth.num_pixels());
  }

 private:
  static constexpr std::size_t kGrain = 1024;  // pixels a block

  Image dL_dx_, dL_dy_;  // [H][W][3] gradients of the differences
};

}  // namespace glint
