// SPDX-License-Identifier: MIT
// Surfels under density control, whose views say what a test wants.
#pragma once

#include <cmath>

#include "glint/train/densify.h"

namespace glint::test {

inline constexpr float kSmall = 0.001f, kLarge = 0.5f;  // metres

// Opaque surfels in the plane z = 0, facing z, that nothing asks to clone or to prune.
inline SurfelCloud cloud_of(std::size_t count) {
  SurfelCloud cloud;
  cloud.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    cloud.rotations[4 * i] = 1;
    cloud.means[3 * i] = static_cast<float>(i);
    cloud.opacity_logits[i] = 1;
    cloud.log_scales[2 * i] = cloud.log_scales[2 * i + 1] = std::log(kSmall);
  }
  return cloud;
}

inline DensifyConfig every_step() {
  DensifyConfig config;
  config.from = 0;
  config.interval = 1;
  config.until = 1000;
  config.reset_interval = 10;
  config.prune_holiday = 0;
  return config;
}

// With an optimiser that knows the surfels, and has not moved them.
struct DensifiedSet {
  SurfelCloud cloud;
  SurfelAdam adam;
  Densifier densifier;

  DensifiedSet(const DensifyConfig& config, SurfelCloud surfels, float extent = 1)
      : cloud(std::move(surfels)), densifier(config, extent, 0) {
    SurfelCloud gradient;
    gradient.extra_names = cloud.extra_names;
    gradient.resize(cloud.size());
    SurfelRates rates;
    rates.extra.resize(cloud.num_extra());
    adam.step(cloud, gradient, rates, 1);
  }
  DensifiedSet(const DensifyConfig& config, std::size_t count)
      : DensifiedSet(config, cloud_of(count)) {}

  // One view; a surfel of weight 0 is not in it.
  void observe(const std::vector<float>& weights, const std::vector<float>& gradients) {
    RasterOutput output;
    RasterGradient gradient;
    output.alpha = Image(960, 540, 1);  // the size that the threshold is for
    for (std::size_t i = 0; i < weights.size(); ++i) {
      output.in_view.push_back(weights[i] > 0);
      output.visibility.push_back(weights[i]);
      for (const float value : {gradients[i], 0.0f}) gradient.screen.push_back(value);
    }
    densifier.observe(output, gradient);
  }
  void observe(const std::vector<float>& weights) {
    observe(weights, std::vector<float>(weights.size(), 0.0f));
  }
  DensifyCounts update(int step) { return densifier.update(step, cloud, adam); }
};

inline void enlarge(SurfelCloud& cloud, std::size_t i) {
  cloud.log_scales[2 * i] = cloud.log_scales[2 * i + 1] = std::log(kLarge);
}

}  // namespace glint::test
