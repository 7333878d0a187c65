// SPDX-License-Identifier: MIT
#include "glint/train/transparency_prior.h"

#include "glint/core/kernel.h"
#include "glint/train/check_fits.h"
#include "glint/train/transparency_kernels.h"

namespace glint {

template <class T>
double TransparencyPriorLoss::evaluate(
    const BasicImage<T>& transparency, const Image& image, T weight, BasicImage<T>& dL_dtransparency
) const {
  check_fits("image of the transparency prior", image, transparency.size(), 3);
  const auto num_pixels = static_cast<double>(transparency.num_pixels());
  const TransparencyPriorAt<T> loss_at{
      {{transparency.on_device()}, image.on_device(), static_cast<T>(edge_sharpness)},
      static_cast<T>(entropy),
      static_cast<T>(sparsity),
      static_cast<T>(smoothness),
      weight / static_cast<T>(num_pixels),
      dL_dtransparency.on_device()};
  return sum_kernel(transparency.size(), loss_at) / num_pixels;
}

template double TransparencyPriorLoss::evaluate(const Image&, const Image&, float, Image&) const;
template double TransparencyPriorLoss::
    evaluate(const BasicImage<double>&, const Image&, double, BasicImage<double>&) const;

}  // namespace glint
