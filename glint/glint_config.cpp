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
  geometry.lambda_consistency = 0.1f;
  geometry.near_consistency = geometry.cosine_consistency = true;
  geometry.lambda_smooth = PriorLosses::kLambdaSmooth;
  geometry.smooth_from = PriorLosses::kSmoothFrom;
  perceptual.lambda_lpips = 0.05f;
  transmission_losses.transparency_from = 5000;
  transmission_losses.lambda_direct = 1;
  transmission_losses.direct_lpips = true;
  transmission_losses.lambda_direct_consistency = 0.1f;
  transmission_losses.direct_near_consistency = true;
  transmission_losses.direct_cosine_consistency = true;
  transmission_losses.lambda_plausible = 0.05f;
  transmission_losses.lambda_transparency_prior = 0.01f;
  transmission_losses.masked_transparency_prior = true;
  densify.until = 21000;
  densify.slow_interval = 500;
  densify.min_opacity = 0.08f;
  densify.min_surfels = 1024;
  densify.scale_limit = 0.1f;
  rates.settle_from = densify.until;
  rates.settle_until = 45000;
}

GlintConfig GlintConfig::scaled_to(int iterations) const {
  GlintConfig run = *this;
  const auto scaled = [&](int published, int at_least = 1) {
    return scaled_step(published, iterations, at_least, kPublishedIterations);
  };
  for (int* window :
       {&run.transmission_from, &run.reflection_from, &run.sh_interval, &run.perceptual.lpips_from})
    *window = scaled(*window);
  run.freeze_from = scaled(freeze_from, freeze_at_least);
  run.rates = rates.for_shorter_run(static_cast<double>(kPublishedIterations) / iterations);
  run.geometry.scale(scaled);
  run.transmission_losses.scale(scaled);
  run.densify.scale(scaled);
  run.multi_view.from = scaled(multi_view.from);
  run.multi_view.until = scaled(multi_view.until);
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
  if (reset_transparency) config.channel_resets.push_back({kTransparency, initial_transparency});
  if (reset_specular)
    config.channel_resets.push_back(
        {kSpecular, initial_specular, std::max(first, reflection_from) + 1}
    );
  return config;
}

DensifyConfig GlintConfig::secondary_densify() const {
  DensifyConfig config = densify;
  config.interval = secondary_densify_interval;
  config.slow_interval = 0;
  config.reset_interval = secondary_reset_interval;
  config.resets = reset_secondary;
  config.prune_light_large = secondary_prune_light_large;
  config.scale_limit = secondary_scale_limit;
  return config;
}

DensifyConfig GlintConfig::transmission_densify() const {
  DensifyConfig config = secondary_densify();
  config.gradient_threshold = transmission_gradient;
  config.wait_from(secondary_run_clock ? transmission_from : 0);
  config.only_weighted_views = transmission_weighted_views;
  if (transmission_min_opacity >= 0) config.min_opacity = transmission_min_opacity;
  config.min_share = transmission_min_share;
  return config;
}

DensifyConfig GlintConfig::reflection_densify(ImageSize size) const {
  DensifyConfig config = secondary_densify();
  config.max_scale *= grid.coarseness(size);
  config.gradient_threshold = reflection_gradient;
  config.gradient_quantile = reflection_quantile;
  config.min_share = reflection_min_share;
  config.wait_from(secondary_run_clock ? reflection_from : 0);
  return config;
}

SurfelRates GlintConfig::secondary_rates(int from) const {
  SurfelRates result = rates;
  result.first_step = from;
  result.run_clock = run_clock_rates;
  return result;
}

SurfelRates GlintConfig::reflection_rates() const {
  SurfelRates result = secondary_rates(reflection_from);
  result.sh_dc *= reflection_color_rate;
  result.sh_rest *= reflection_color_rate;
  return result;
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

Json glint_release_overrides() {
  return Json{
      {"lpips_unit_range", true},
      {"transmission_from", 1000},
      {"reflection_from", 3000},
      {"freeze_from", 31000},
      {"freeze", "geometry"},
      {"depth_gradient_scales", 4},
      {"near_first", true},
      {"weighted_normals", true},
      {"min_cosine", 0.5},
      {"guidance", "release"},
      {"lambda_transparency", 0.01},
      {"depth_threshold", 0.005},
      {"mirror_share_below", 0.0},
      {"mirror_transmittance", kMinTransmittance},
      {"mirror_hits", 256},
  };
}

Json glint_text_overrides() {
  return Json{
      {"detach_transparency", false},
      {"initial_transparency", 0.1},
      {"l1_weight", 0.8},
      {"ssim_weight", 0.2},
      {"lambda_lpips", 0.01},
      {"lambda_multi_view", 0.0},
      {"lambda_depth", 0.1},
      {"lambda_normal", 0.1},
      {"lambda_consistency", 0.05},
      {"consistency_from", 14000},  // the share of the run that [Huang24] leaves it off
      {"near_consistency", false},
      {"cosine_consistency", false},
      {"lambda_smooth", 0.01},
      {"transparency_from", 7000},
      {"lambda_direct", 0.0},
      {"direct_lpips", false},
      {"lambda_direct_consistency", 0.0},
      {"lambda_plausible", 0.0},
      {"lambda_transparency_prior", 0.0},
      {"densify_until", 30000},
      {"densify_slow_interval", 0},
      {"min_opacity", 0.05},
      {"min_surfels", 0},
      {"scale_limit", 0.0},
      {"reflection_gradient", 1e-4},
      {"reflection_quantile", 0.0},
      {"secondary_run_clock", false},
      {"secondary_densify_interval", 100},
      {"secondary_reset_interval", 3000},
      {"reset_secondary", false},
      {"reset_transparency", false},
      {"transmission_min_opacity", -1.0},
      {"transmission_min_share", 0.0},
      {"reflection_min_share", 0.0},
      {"secondary_prune_light_large", false},
      {"secondary_scale_limit", 0.0},
      {"position_steps", 60000},
      {"freeze_at_least", 10000},
      {"run_clock_rates", false},
      {"mirror_observe_every", 0},
  };
}

// docs/GLINT_NOTES.md has what each does alone.
Json glint_plus_overrides() {
  Json overrides = glint_text_overrides();
  overrides.update({
      // Both secondary sets start as copies of the interface, and a quarter of the resets.
      {"clone_interface", true},
      {"clone_reflection", true},
      {"opacity_reset_interval", 12000},
      // The row's weights of photos and geometry.
      {"l1_weight", 1.2},
      {"ssim_weight", 0.4},
      {"lambda_depth", 0.05},
      {"lambda_normal", 0.3},
      {"lambda_consistency", 0.1},
      {"consistency_from", 0},
      {"near_consistency", true},
      {"unit_consistency", true},
      {"lambda_smooth", 0.05 / 3},
      // The row's growth, by rays of their own.
      {"densify_until", 21000},
      {"densify_slow_interval", 500},
      {"min_opacity", 0.08},
      {"transmission_min_opacity", 0.05},
      {"mirror_observe_every", 4},
      // The transmission set alone is held to the photos, less than in the row.
      {"lambda_direct", 0.3},
      {"lambda_direct_consistency", 0.1},
      {"direct_near_consistency", true},
      // Once the sets are grown, rates fall: what is left of the run averages over views and noise.
      {"rate_settled", 0.03},
      {"freeze", "nothing"},
  });
  return overrides;
}

Json glint_oracle_overrides() {
  return Json{
      {"oracle", true},
      {"lambda_transparency", 0.0},
      {"lambda_transparency_prior", 0.0},
      {"lambda_plausible", 0.0},
  };
}

}  // namespace glint
