// SPDX-License-Identifier: MIT
#include "glint/train/exposure.h"

#include "glint/core/error.h"
#include "glint/core/kernel.h"
#include "glint/render/map_ops.h"
#include "glint/render/void_steps.h"
#include "glint/train/training_state.h"

namespace glint {

void ExposureLoss::visit_state(TrainingState& state) {
  numbers_.clear();
  steps_.clear();
  for (const ViewExposure& e : std::as_const(exposures_)) {
    for (const double number :
         {e.log_gain, e.offset, e.first[0], e.first[1], e.second[0], e.second[1]})
      numbers_.push_back(number);
    steps_.push_back(static_cast<std::uint32_t>(e.steps));
  }
  state("numbers", numbers_);
  state("steps", steps_);
  if (!state.reading()) return;
  GLINT_CHECK(
      steps_.size() == exposures_.size() && numbers_.size() == 6 * steps_.size(),
      kBadReference,
      "exposures of {} views, expected {}",
      steps_.size(),
      exposures_.size()
  );
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const double* n = &numbers_[6 * i];
    exposures_[i] = {n[0], n[1], {n[2], n[3]}, {n[4], n[5]}, static_cast<int>(steps_[i])};
  }
}

PhotometricTerms ExposureLoss::evaluate(
    std::size_t view,
    int iteration,
    const Image& rendered,
    const Photo& photo,
    PhotometricWeights weights,
    Image& gradient
) {
  if (exposures_.empty() || iteration < config_.from)
    return photometric_.evaluate(rendered, photo, weights, gradient);
  PhotometricTerms terms =
      photometric_.evaluate(rendered, photo, {0, weights.ssim}, gradient, &ssim_sum_);
  GLINT_CHECK(view < exposures_.size(), kUsage, "exposure: there is no view {}", view);
  ViewExposure* exposure = exposures_.device_for_writing() + view;
  applied_.resize(1);
  run_kernel(
      1,
      1,
      ApplyExposure{
          exposure,
          ssim_sum_.on_device(),
          static_cast<double>(3 * rendered.num_pixels()),
          static_cast<double>(config_.max_ssim_loss),
          applied_.on_device()}
  );
  const AppliedExposure* applied = applied_.on_device();
  fit(exposed_, rendered.size(), 3);
  run_kernel(
      3 * rendered.num_pixels(), 4096, Expose{rendered.on_device(), applied, exposed_.on_device()}
  );
  clear_image(dL_dexposed_, rendered.size(), 3);
  terms.l1 = photometric_.evaluate(exposed_, photo, {weights.l1, 0}, dL_dexposed_).l1;
  sum_kernel_to(
      rendered.size(),
      ExposeVjp{rendered.on_device(), dL_dexposed_.on_device(), applied, gradient.on_device()},
      sums_
  );
  run_kernel(
      1,
      1,
      StepExposure{
          applied, sums_.on_device(), static_cast<double>(config_.rate), exposure, void_word()}
  );
  return terms;
}

}  // namespace glint
