// SPDX-License-Identifier: MIT
// Means over a mask of what a formula of masked_mean_kernels.h says of a map of one channel.
#pragma once

#include "glint/render/map_kernels.h"
#include "glint/train/masked_mean_kernels.h"
#include "glint/train/share_kernels.h"

namespace glint {

// sum m f(t) / sum m, 0 for an empty mask. t, mask: [H][W][1]. Adds weight * gradient to dL_dt.
template <class Of, class T>
double masked_mean(
    const BasicImage<T>& t, const Image& mask, Of of, T weight, BasicImage<T>& dL_dt
) {
  Array<double> mask_sum;
  Array<T> scale;
  sum_kernel_to(t.size(), SumPixels{mask.on_device()}, mask_sum);
  share_of(mask_sum.on_device(), weight, scale);
  const MaskedSumAt<T, Of> loss_at{
      t.on_device(), mask.on_device(), of, scale.on_device(), dL_dt.on_device()};
  const double sum = sum_kernel(t.size(), loss_at), count = told(mask_sum);
  return count == 0 ? 0 : sum / count;
}

}  // namespace glint
