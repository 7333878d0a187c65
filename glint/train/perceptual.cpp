// SPDX-License-Identifier: MIT
#include "glint/train/perceptual.h"

#include <fmt/format.h>

namespace glint {

std::unique_ptr<PerceptualLoss> make_perceptual_loss(std::string& why) {
  why = "its network is not built in";
  return nullptr;
}

std::unique_ptr<PerceptualLoss> wanted_perceptual_loss(
    PerceptualConfig& config, const std::string& method, std::vector<std::string>& warnings
) {
  if (config.lambda_lpips <= 0) return nullptr;
  std::string why;
  auto loss = make_perceptual_loss(why);
  if (loss == nullptr) {
    config.lambda_lpips = 0;
    warnings.push_back(fmt::format("{}: LPIPS is off: {}", method, why));
  }
  return loss;
}

void add_perceptual(
    PerceptualLoss* loss,
    const PerceptualConfig& config,
    int iteration,
    const Image& rendered,
    const Image& target,
    Image& dL_drendered,
    StepStats& stats
) {
  if (loss == nullptr || iteration < config.lpips_from) return;
  const float weight = config.lambda_lpips;
  stats.terms["lpips"] =
      static_cast<double>(weight) * loss->evaluate(rendered, target, weight, dL_drendered);
}

}  // namespace glint
