// SPDX-License-Identifier: MIT
#include "baselines/planar/lobe_appearance.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>

#include "glint/core/error.h"
#include "glint/core/kernel.h"
#include "glint/train/adam.h"
#include "glint/train/row_kernels.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 256;  // surfels a block

// i-th of `count` numbers from 0 to `end`, both among them.
double evenly(double end, int i, int count) { return count < 2 ? 0 : end * i / (count - 1); }

}  // namespace

LobeRates LobeRates::for_shorter_run(double shortening) const {
  const float faster = faster_rates(shortening);
  return {faster * feature, faster * network, faster * network_final};
}

void mark_in_pyramid(const SurfelCloud& cloud, const Camera& camera, Array<std::uint8_t>& visible) {
  visible.resize(cloud.size());
  run_kernel(
      cloud.size(),
      4 * kGrain,
      MarkInPyramid{
          cloud.means.on_device(),
          cloud.log_scales.on_device(),
          pinhole_of<float>(camera),
          cast<float>(camera.rotation_cam_from_world),
          cast<float>(camera.translation_cam_from_world),
          visible.on_device()}
  );
}

LobeAppearance::LobeAppearance(
    const LobeAppearanceConfig& config, std::size_t count, std::uint64_t seed
)
    : config_(config), count_(count) {
  for (const int size : {config.feature, config.theta, config.phi, config.hidden})
    GLINT_CHECK(size > 0, kUsage, "lobe appearance: a size is {}, expected positive ones", size);
  // The last axis around is the first again, and all are one at each pole: as published.
  for (int t = 0; t < config.theta; ++t)
    for (int p = 0; p < config.phi; ++p) {
      const double theta = evenly(std::numbers::pi, t, config.theta);
      const double phi = evenly(2 * std::numbers::pi, p, config.phi);
      const LobeFrame<double> f =
          lobe_frame(std::sin(theta), std::cos(theta), std::sin(phi), std::cos(phi));
      frames_.push_back(
          {cast<float>(f.axis), cast<float>(f.tangent_theta), cast<float>(f.tangent_phi)}
      );
    }
  features_ = TrainableArray(count * static_cast<std::size_t>(config.feature));
  to_lobes_ = Mlp({config.feature, kLobeNumbers * config.num_lobes()}, seed);
  to_color_ = Mlp({config.input_width(), config.hidden, config.hidden, 3}, seed + 1);
  // As published, where the networks' other parameters start as PyTorch's do.
  std::fill_n(to_color_.biases(2).begin(), 3, 0.0f);
}

// On a GPU all are asked, since the host would have to wait for their number, and the answers of
// the others cleared.
void LobeAppearance::find_visible(const Array<std::uint8_t>& visible) {
  if (on_gpu()) {
    if (surfels_.size() == visible.size()) return;
    surfels_.resize(visible.size());
    std::iota(surfels_.begin(), surfels_.end(), 0u);
    return;
  }
  surfels_.clear();
  for (std::size_t i = 0; i < visible.size(); ++i)
    if (visible[i] != 0) surfels_.push_back(static_cast<std::uint32_t>(i));
}

const FloatArray& LobeAppearance::forward(
    const FloatArray& means, Vec3f eye, const Array<std::uint8_t>& visible
) {
  GLINT_CHECK(
      means.size() == 3 * count_ && visible.size() == count_,
      kUsage,
      "lobe appearance: made for {} surfels, found {} means, {} visibilities",
      count_,
      means.size() / 3,
      visible.size()
  );
  find_visible(visible);
  view_ = {means.on_device(), eye};
  const std::size_t m = surfels_.size(), width = static_cast<std::size_t>(config_.feature);
  seen_features_.resize(m * width);
  run_kernel(
      m * width,
      kGrain * width,
      GatherRows{
          features_.values.on_device(), surfels_.on_device(), width, seen_features_.on_device()}
  );
  numbers_ = &to_lobes_.forward(seen_features_);
  const auto input = static_cast<std::size_t>(config_.input_width());
  inputs_.resize(m * input);
  run_kernel(
      m,
      kGrain,
      LobeInputs{
          surfels_.on_device(),
          view_,
          frames_.on_device(),
          frames_.size(),
          input,
          numbers_->on_device(),
          inputs_.on_device()}
  );
  const FloatArray& colors = to_color_.forward(inputs_);
  offsets_.resize(3 * count_);
  offsets_.fill(0.0f);
  run_kernel(
      3 * m, kGrain, AddToRows{colors.on_device(), surfels_.on_device(), 3, offsets_.on_device()}
  );
  seen_ = &visible;
  clear_unseen(offsets_);
  return offsets_;
}

void LobeAppearance::clear_unseen(FloatArray& rows) const {
  if (on_gpu()) run_kernel(rows.size(), kGrain, ClearUnseen{seen_->on_device(), rows.on_device()});
}

const FloatArray& LobeAppearance::forward(const SurfelCloud& cloud, const Camera& camera) {
  mark_in_pyramid(cloud, camera, visible_);
  return forward(cloud.means, cast<float>(camera.center()), visible_);
}

void LobeAppearance::backward(const RasterGradient& gradient, int channels) {
  color_gradient(gradient, channels, dL_doffsets_);
  backward(dL_doffsets_);
}

void LobeAppearance::backward(const FloatArray& dL_doffsets) {
  GLINT_CHECK(
      numbers_ != nullptr && dL_doffsets.size() == offsets_.size(),
      kUsage,
      "lobe appearance: gradients of {} values, the last forward() gave {}",
      dL_doffsets.size(),
      offsets_.size()
  );
  const std::size_t m = surfels_.size(), width = static_cast<std::size_t>(config_.feature);
  dL_dcolors_.resize(3 * m);
  run_kernel(
      3 * m,
      kGrain,
      GatherRows{dL_doffsets.on_device(), surfels_.on_device(), 3, dL_dcolors_.on_device()}
  );
  clear_unseen(dL_dcolors_);
  dL_dinputs_.resize(inputs_.size());
  to_color_.backward(dL_dcolors_, &dL_dinputs_);
  dL_dnumbers_.resize(numbers_->size());
  run_kernel(
      m,
      kGrain,
      LobeInputsVjp{
          surfels_.on_device(),
          view_,
          frames_.on_device(),
          frames_.size(),
          static_cast<std::size_t>(config_.input_width()),
          numbers_->on_device(),
          dL_dinputs_.on_device(),
          dL_dnumbers_.on_device()}
  );
  dL_dfeatures_.resize(seen_features_.size());
  to_lobes_.backward(dL_dnumbers_, &dL_dfeatures_);
  run_kernel(
      m * width,
      kGrain * width,
      AddToRows{
          dL_dfeatures_.on_device(), surfels_.on_device(), width, features_.gradient.on_device()}
  );
}

void LobeAppearance::step(int step, int steps) {
  const LobeRates& rates = config_.rates;
  // Linear, not log-linear as that of positions.
  const float t = std::clamp(static_cast<float>(step) / static_cast<float>(steps), 0.0f, 1.0f);
  const float rate = (1 - t) * rates.network + t * rates.network_final;
  features_.step(rates.feature);
  to_lobes_.parameters().step(rate);
  to_color_.parameters().step(rate);
}

std::vector<TensorToWrite> LobeAppearance::tensors(const std::string& name) const {
  std::vector<TensorToWrite> tensors = to_lobes_.tensors(name + ".to_lobes");
  for (TensorToWrite& tensor : to_color_.tensors(name + ".to_color"))
    tensors.push_back(std::move(tensor));
  tensors.push_back(float_tensor(
      name + ".features", {count_, static_cast<std::size_t>(config_.feature)}, features_.values
  ));
  return tensors;
}

void LobeAppearance::read(SafetensorsFile& file, const std::string& name) {
  to_lobes_.read(file, name + ".to_lobes");
  to_color_.read(file, name + ".to_color");
  read_floats(
      file,
      name + ".features",
      {count_, static_cast<std::size_t>(config_.feature)},
      features_.values
  );
}

void LobeAppearance::check_finite(const std::string& name) const {
  features_.check_finite(name + " features");
  to_lobes_.parameters().check_finite(name + " to_lobes");
  to_color_.parameters().check_finite(name + " to_color");
}

}  // namespace glint
