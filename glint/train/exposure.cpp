// SPDX-License-Identifier: MIT
#include "glint/train/exposure.h"

#include <cmath>

#include "glint/core/kernel.h"
#include "glint/render/map_ops.h"
#include "glint/train/exposure_kernels.h"

namespace glint {

void ViewExposure::adam_step(double dL_dlog_gain, double dL_doffset, double rate) {
  constexpr double kBeta1 = 0.9, kBeta2 = 0.999, kEpsilon = 1e-8;
  ++steps;
  const double gradients[2] = {dL_dlog_gain, dL_doffset};
  double* parameters[2] = {&log_gain, &offset};
  for (int i = 0; i < 2; ++i) {
    first[i] += (1 - kBeta1) * (gradients[i] - first[i]);
    second[i] += (1 - kBeta2) * (gradients[i] * gradients[i] - second[i]);
    const double m = first[i] / (1 - std::pow(kBeta1, steps));
    const double v = second[i] / (1 - std::pow(kBeta2, steps));
    *parameters[i] -= rate * m / (std::sqrt(v) + kEpsilon);
  }
}

PhotometricTerms ExposureLoss::evaluate(
    std::size_t view,
    int iteration,
    const Image& rendered,
    const Image& target,
    PhotometricWeights weights,
    Image& gradient
) {
  if (exposures_.empty() || iteration < config_.from)
    return photometric_.evaluate(rendered, target, weights, gradient);
  PhotometricTerms terms = photometric_.evaluate(rendered, target, {0, weights.ssim}, gradient);
  const PhotometricWeights l1{weights.l1, 0};
  if (terms.ssim_loss >= static_cast<double>(config_.max_ssim_loss)) {
    photometric_.evaluate(rendered, target, l1, gradient);
    return terms;
  }
  ViewExposure& exposure = exposures_.at(view);
  const auto gain = static_cast<float>(std::exp(exposure.log_gain));
  fit(exposed_, rendered.size(), 3);
  run_kernel(
      rendered.values().size(),
      4096,
      Expose{rendered.on_device(), gain, static_cast<float>(exposure.offset), exposed_.on_device()}
  );
  clear_image(dL_dexposed_, rendered.size(), 3);
  terms.l1 = photometric_.evaluate(exposed_, target, l1, dL_dexposed_).l1;
  const ExposureGradient sum = sum_kernel(
      rendered.size(),
      ExposeVjp{rendered.on_device(), dL_dexposed_.on_device(), gain, gradient.on_device()}
  );
  exposure.adam_step(
      static_cast<double>(gain) * sum.gain, sum.offset, static_cast<double>(config_.rate)
  );
  return terms;
}

}  // namespace glint
