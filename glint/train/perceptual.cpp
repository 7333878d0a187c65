// SPDX-License-Identifier: MIT
#include "glint/train/perceptual.h"

#include <map>
#include <optional>

#include "glint/scene/scene.h"
#include "metrics/lpips.h"

namespace glint {
namespace {

class LpipsLoss final : public PerceptualLoss {
 public:
  LpipsLoss(std::shared_ptr<const LpipsWeights> weights, LpipsRange range, const Scene& scene)
      : lpips_(std::move(weights), range) {
    for (std::size_t i = 0; i < scene.train.size(); ++i) photos_[&scene.train[i].rgb] = i;
  }

  bool accepts(ImageSize size) const override { return lpips_.accepts(size); }

 private:
  double evaluate_all(const Image& rendered, const Image& target, float weight, Image& dL_drendered)
      override {
    return lpips_.evaluate(rendered, target, weight, dL_drendered, number_of(target));
  }
  std::optional<std::size_t> number_of(const Image& target) const {
    const auto found = photos_.find(&target);
    return found == photos_.end() ? std::nullopt : std::optional(found->second);
  }

  Lpips lpips_;
  std::map<const Image*, std::size_t> photos_;  // only compared with
};

std::shared_ptr<const LpipsWeights> weights_here() {
  for (const char* network : {"vgg", "alex"})
    if (auto weights = lpips_weights_at(lpips_weights_place(), network)) return weights;
  return nullptr;
}

std::string name_of(const LpipsWeights* weights) {
  return weights ? fmt::format("{}, sha256 {}", weights->network, weights->sha256) : "";
}

}  // namespace

std::unique_ptr<PerceptualLoss> make_perceptual_loss(
    const Scene& scene, bool unit_range, std::string& note
) {
  const LpipsRange range = unit_range ? LpipsRange::kUnit : LpipsRange::kSymmetric;
  auto weights = weights_here();
  note = weights ? name_of(weights.get()) : "no weights";
  return weights ? std::make_unique<LpipsLoss>(std::move(weights), range, scene) : nullptr;
}

std::string perceptual_network() {
  static const std::string name = name_of(weights_here().get());
  return name;
}

std::unique_ptr<PerceptualLoss> wanted_perceptual_loss(
    PerceptualConfig& config,
    const Scene& scene,
    const std::string& method,
    std::vector<std::string>& warnings
) {
  if (config.lambda_lpips <= 0) return nullptr;
  std::string note;
  auto loss = make_perceptual_loss(scene, config.lpips_unit_range, note);
  for (const View& view : scene.train)
    if (loss != nullptr && !loss->accepts(view.camera.size())) {
      loss = nullptr;
      note = fmt::format("{} is too small for the network", view.name);
    }
  if (loss == nullptr) config.lambda_lpips = 0;
  warnings.push_back(fmt::format("{}: LPIPS is {}: {}", method, loss ? "on" : "off", note));
  return loss;
}

void add_perceptual(
    PerceptualLoss* loss,
    const PerceptualConfig& config,
    int iteration,
    const Image& rendered,
    const Photo& photo,
    Image& dL_drendered,
    StepStats& stats
) {
  if (loss == nullptr || iteration < config.lpips_from) return;
  const float weight = config.lambda_lpips;
  stats.terms["lpips"] =
      static_cast<double>(weight) * loss->evaluate(rendered, photo, weight, dL_drendered);
}

}  // namespace glint
