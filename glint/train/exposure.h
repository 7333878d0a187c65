// SPDX-License-Identifier: MIT
// Exposure compensation [Chen24 Sec. 4.4]: each training view's picture is exp(a) I + b of the
// render I before it is compared with the photo by L1. SSIM sees the render as it is, and so do
// test views.
#pragma once

#include <vector>

#include "glint/core/image.h"
#include "glint/train/photometric.h"

namespace glint {

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

// Of one view, and its moments [Kingma15].
struct ViewExposure {
  double log_gain = 0, offset = 0;
  double first[2] = {}, second[2] = {};
  int steps = 0;

  void adam_step(double dL_dlog_gain, double dL_doffset, double rate);
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
      const Image& target,
      PhotometricWeights weights,
      Image& gradient
  );
  const std::vector<ViewExposure>& exposures() const { return exposures_; }

 private:
  ExposureConfig config_;
  std::vector<ViewExposure> exposures_;
  PhotometricLoss photometric_;
  Image exposed_, dL_dexposed_;
};

}  // namespace glint
