// SPDX-License-Identifier: MIT
#include "glint/train/transparency_prior.h"

#include "glint/train/pixel_sums.h"

namespace glint {

template <class T>
double TransparencyPriorLoss::evaluate(
    const BasicImage<T>& transparency, const Image& image, T weight, BasicImage<T>& dL_dtransparency
) const {
  check_fits("image of the transparency prior", image, transparency.size(), 3);
  const auto exists = [](const T*) { return true; };
  const auto num_pixels = static_cast<double>(transparency.num_pixels());
  const T sharpness = static_cast<T>(edge_sharpness), scale = weight / static_cast<T>(num_pixels);
  const T w_entropy = static_cast<T>(entropy), w_sparsity = static_cast<T>(sparsity);
  const T w_smoothness = static_cast<T>(smoothness);
  const double sum = sum_over_pixels(transparency.size(), [&](int x, int y) {
    const T t = transparency.at(x, y);
    const auto smooth = edge_aware_smoothness_at<1>(transparency, image, sharpness, exists, x, y);
    T& gradient = dL_dtransparency.at(x, y);
    binary_entropy_vjp(t, scale * w_entropy, gradient);
    gradient += scale * (w_sparsity * sign_of(t) + w_smoothness * smooth.gradient[0]);
    return static_cast<double>(w_entropy * binary_entropy(t) + w_sparsity * abs_of(t)) +
           static_cast<double>(w_smoothness) * smooth.loss;
  });
  return sum / num_pixels;
}

template double TransparencyPriorLoss::evaluate(const Image&, const Image&, float, Image&) const;
template double TransparencyPriorLoss::
    evaluate(const BasicImage<double>&, const Image&, double, BasicImage<double>&) const;

}  // namespace glint
