// SPDX-License-Identifier: MIT
#include "glint/train/normal_smoothness.h"

#include "glint/core/kernel.h"
#include "glint/train/check_fits.h"
#include "glint/train/normal_kernels.h"

namespace glint {

template <class T>
double NormalSmoothnessLoss::evaluate(
    const BasicImage<T>& normal, const Image& image, T weight, BasicImage<T>& dL_dnormal
) const {
  check_fits("image of the normal smoothness", image, normal.size(), 3);
  const auto num_pixels = static_cast<double>(normal.num_pixels());
  const NormalSmoothnessAt<T> loss_at{
      {{normal.on_device()}, image.on_device(), static_cast<T>(edge_sharpness)},
      weight / static_cast<T>(num_pixels),
      dL_dnormal.on_device()};
  return sum_kernel(normal.size(), loss_at) / num_pixels;
}

template double NormalSmoothnessLoss::evaluate(const Image&, const Image&, float, Image&) const;
template double
NormalSmoothnessLoss::evaluate(const BasicImage<double>&, const Image&, double, BasicImage<double>&)
    const;

}  // namespace glint
