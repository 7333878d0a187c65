// SPDX-License-Identifier: MIT
#include "glint/glint_config.h"

#include <algorithm>

#include "glint/core/error.h"
#include "glint/train/trainer.h"

namespace glint {

GlintConfig::GlintConfig() {
  geometry.lambda_depth = PriorLosses::kLambdaDepth;
  geometry.lambda_normal = PriorLosses::kLambdaNormal;
  geometry.min_cosine = PriorLosses::kMinCosine;
  geometry.gate_from = PriorLosses::kGateFrom;
  geometry.lambda_consistency = 0.05f;
  geometry.consistency_from = 14000;  // the share of the run that [Huang24] leaves it off
  geometry.lambda_smooth = PriorLosses::kLambdaSmooth;
  geometry.smooth_from = PriorLosses::kSmoothFrom;
  densify.until = 30000;
  rates.means_steps = kPublishedIterations;
}

GlintConfig GlintConfig::scaled_to(int iterations) const {
  GlintConfig run = *this;
  const auto scaled = [&](int published, int at_least = 1) {
    return scaled_step(published, iterations, at_least, kPublishedIterations);
  };
  for (int* window :
       {&run.transmission_from, &run.reflection_from, &run.sh_interval, &run.perceptual.lpips_from})
    *window = scaled(*window);
  // Deviation: in short runs the interface has not converged by two thirds of them, and freezing it
  // there costs quality; it trains for as many steps as it takes, or to the end.
  run.freeze_from = scaled(freeze_from, freeze_at_least);
  run.rates = rates.for_shorter_run(static_cast<double>(kPublishedIterations) / iterations);
  run.geometry.scale(scaled);
  run.transmission_losses.scale(scaled);
  run.densify.scale(scaled);
  run.bootstrap.scale(scaled);
  run.secondary_densify_interval = scaled(secondary_densify_interval, 50);
  // At least 300 steps for each published 3000, as the interface has them.
  run.secondary_reset_interval = scaled(secondary_reset_interval, secondary_reset_interval / 10);
  if (!with_transmission) run.transmission_losses.lambda_transparency = 0;
  return run;
}

// s is first reset with the second reset of opacities, as published, and once reflection takes
// part.
DensifyConfig GlintConfig::interface_densify(std::size_t training_views) const {
  DensifyConfig config = densify;
  const int first = densify.for_views(training_views).reset_interval;
  if (reset_channels)
    config.channel_resets = {
        {kTransparency, initial_transparency},
        {kSpecular, initial_specular, std::max(first, reflection_from) + 1}};
  return config;
}

DensifyConfig GlintConfig::secondary_densify() const {
  DensifyConfig config = densify;
  config.interval = secondary_densify_interval;
  config.slow_interval = 0;
  config.reset_interval = secondary_reset_interval;
  config.resets = reset_secondary;
  if (secondary_max_surfels > 0) config.max_surfels = secondary_max_surfels;
  return config;
}

DensifyConfig GlintConfig::transmission_densify() const {
  DensifyConfig config = secondary_densify();
  config.gradient_threshold = transmission_gradient;
  config.wait_from(secondary_run_clock ? transmission_from : 0);
  config.only_weighted_views = transmission_weighted_views;
  if (transmission_min_opacity >= 0) config.min_opacity = transmission_min_opacity;
  return config;
}

DensifyConfig GlintConfig::reflection_densify(ImageSize size) const {
  DensifyConfig config = secondary_densify();
  config.max_scale *= grid.coarseness(size);
  config.gradient_threshold = reflection_gradient;
  config.wait_from(secondary_run_clock ? reflection_from : 0);
  return config;
}

void GlintConfig::check() const {
  GLINT_CHECK(
      transmission == "raster" || transmission == "trace",
      kUsage,
      "glint: transmission is '{}', expected raster or trace",
      transmission
  );
  GLINT_CHECK(
      freeze == "all" || freeze == "geometry" || freeze == "nothing",
      kUsage,
      "glint: freeze is '{}', expected all, geometry or nothing",
      freeze
  );
  transmission_losses.check("glint");
}

// The release takes means of smoothness over the three components, too.
constexpr double kReleaseSmooth = 0.05 / 3;

Json glint_release_overrides() {
  return Json{
      {"detach_origins", true},
      {"secondary_near", 0.06},
      {"mirror_near", 0.06},
      {"initial_transparency", 0.01},
      {"transmission_from", 1000},
      {"reflection_from", 3000},
      {"freeze_from", 31000},
      {"freeze", "geometry"},
      {"l1_weight", 1.2},
      {"ssim_weight", 0.4},
      {"lambda_lpips", 0.05},
      {"lpips_unit_range", true},
      {"lambda_depth", 0.05},
      {"depth_gradient_scales", 4},
      {"lambda_normal", 0.3},
      {"near_first", true},
      {"min_cosine", 0.5},
      {"lambda_consistency", 0.1},
      {"consistency_from", 0},
      {"near_consistency", true},
      {"lambda_smooth", kReleaseSmooth},
      {"guidance", "release"},
      {"lambda_transparency", 0.01},
      {"transparency_from", 5000},
      {"depth_threshold", 0.005},
      {"lambda_direct", 1.0},
      {"direct_lpips", true},
      {"lambda_direct_consistency", 0.1},
      {"direct_near_consistency", true},
      {"lambda_direct_smooth", 0.1 * kReleaseSmooth},
      {"lambda_opacity", 0.01},
      {"lambda_plausible", 0.05},
      {"lambda_transparency_prior", 0.01},
      {"densify_until", 21000},
      {"densify_slow_interval", 500},
      {"split_large", true},
      {"cap_by_visibility", true},
      {"max_surfels", 2000000},
      {"secondary_max_surfels", 500000},
      {"position_steps", 30000},
      {"min_opacity", 0.08},
      {"transmission_min_opacity", 0.05},
      {"reflection_gradient", 2e-4},
      {"secondary_run_clock", true},
      {"secondary_densify_interval", 500},
      {"secondary_reset_interval", 6000},
      {"reset_secondary", true},
      {"reset_channels", true},
      {"clone_interface", true},
      {"color_sabotage", true},
      {"normal_propagation", true},
      {"sabotage_below", 0.5},
  };
}

}  // namespace glint
