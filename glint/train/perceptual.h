// SPDX-License-Identifier: MIT
// The seam for LPIPS as a training loss [Zhang18]: a network and its weights are no part of this
// layer.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "glint/core/image.h"
#include "glint/method.h"

namespace glint {

class PerceptualLoss {
 public:
  virtual ~PerceptualLoss() = default;
  // rendered, target: [H][W][3]. Adds weight * gradient to dL_drendered and returns the unweighted
  // loss.
  virtual double evaluate(
      const Image& rendered, const Image& target, float weight, Image& dL_drendered
  ) = 0;
};

// When and how much of it a method wants.
struct PerceptualConfig {
  float lambda_lpips = 0.01f;
  int lpips_from = 45000;

  template <class V>
  void visit(V&& v) {
    v("lambda_lpips", lambda_lpips, "weight of LPIPS");
    v("lpips_from", lpips_from, "first published iteration of LPIPS");
  }
};

// Null where no network is built in; `why` says so.
std::unique_ptr<PerceptualLoss> make_perceptual_loss(std::string& why);

// The loss that the config asks for, null without; where there is none, its weight becomes 0, and
// the warning says why.
std::unique_ptr<PerceptualLoss> wanted_perceptual_loss(
    PerceptualConfig& config, const std::string& method, std::vector<std::string>& warnings
);

// Adds the weighted loss to stats.terms and its gradient to dL_drendered, once its iteration has
// come. config: windows of this run; loss: may be null.
void add_perceptual(
    PerceptualLoss* loss,
    const PerceptualConfig& config,
    int iteration,
    const Image& rendered,
    const Image& target,
    Image& dL_drendered,
    StepStats& stats
);

}  // namespace glint
