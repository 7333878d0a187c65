// SPDX-License-Identifier: MIT
// Exposure compensation [Chen24 Sec. 4.4]: each training view's picture is exp(a) I + b of the
// render I before it is compared with the photo by L1. SSIM sees the render as it is, and so do
// test views.
#pragma once

#include "glint/core/image.h"
#include "glint/train/exposure_kernels.h"
#include "glint/train/photometric.h"

namespace glint {

class TrainingState;

struct ExposureConfig {
  bool enabled = false;
  int from = 1000;
  float rate = 1e-3f;
  float max_ssim_loss = 0.5f;

  template <class V>
  void visit(V&& v) {
    v("exposure", enabled, "a gain and an offset for each training view");
    v("exposure_from", from, "first published iteration of exposure");
    v("rate_exposure", rate, "learning rate of gains and offsets");
    v("exposure_max_ssim_loss", max_ssim_loss, "exposure waits while 1 - SSIM is not below");
  }
};

class ExposureLoss {
 public:
  ExposureLoss() = default;
  // `config` with windows of this run.
  ExposureLoss(const ExposureConfig& config, std::size_t num_views)
      : config_(config), exposures_(config.enabled ? num_views : 0) {}

  // PhotometricLoss::evaluate() with the view's exposure where it counts, which then makes a step.
  PhotometricTerms evaluate(
      std::size_t view,
      int iteration,
      const Image& rendered,
      const Photo& photo,
      PhotometricWeights weights,
      Image& gradient
  );
  const Array<ViewExposure>& exposures() const { return exposures_; }
  void visit_state(TrainingState& state);

 private:
  ExposureConfig config_;
  Array<ViewExposure> exposures_;
  PhotometricLoss photometric_;
  // Of this step, where ops run.
  Array<double> ssim_sum_;
  Array<AppliedExposure> applied_;
  Array<ExposureGradient> sums_;
  Image exposed_, dL_dexposed_;
  // The exposures as a checkpoint has them.
  std::vector<double> numbers_;  // [views][6]
  std::vector<std::uint32_t> steps_;
};

}  // namespace glint
