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

DensifyConfig GlintConfig::interface_densify() const {
  DensifyConfig config = densify;
  if (reset_transparency) config.channel_resets.push_back({kTransparency, initial_transparency});
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
  config.only_weighted_views = true;  // as the official code, which traces it
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
  GLINT_CHECK(
      layers == 1 || !with_transmission || transmission == "raster",
      kUsage,
      "glint: layers is {}, and transmission is {}; more than one layer needs raster",
      layers,
      transmission
  );
  transmission_losses.check("glint");
}

void set_release(GlintConfig& config) {
  config.perceptual.lpips_unit_range = true;
  config.transmission_from = 1000;
  config.reflection_from = 3000;
  config.freeze_from = 31000;
  config.freeze = "geometry";
  config.geometry.depth_gradient_scales = 4;
  config.geometry.near_first = config.geometry.weighted_normals = true;
  config.geometry.min_cosine = 0.5f;
  config.transmission_losses.guidance = "release";
  config.transmission_losses.lambda_transparency = 0.01f;
  config.transmission_losses.depth_threshold = 0.005f;
  config.mirror.share_below = 0;
  config.mirror.transmittance = kMinTransmittance;
  config.mirror.hits = 256;
}

void set_text(GlintConfig& config) {
  config.detach_transparency = false;
  config.initial_transparency = 0.1f;
  config.l1_weight = 0.8f;
  config.ssim_weight = 0.2f;
  config.perceptual.lambda_lpips = 0.01f;
  config.multi_view.lambda = 0;
  config.geometry.lambda_depth = config.geometry.lambda_normal = 0.1f;
  config.geometry.lambda_consistency = 0.05f;
  config.geometry.consistency_from = 14000;  // the share of the run that [Huang24] leaves it off
  config.geometry.near_consistency = config.geometry.cosine_consistency = false;
  config.geometry.lambda_smooth = 0.01f;
  TransmissionLossConfig& transmission = config.transmission_losses;
  transmission.transparency_from = 7000;
  transmission.lambda_direct = transmission.lambda_direct_consistency = 0;
  transmission.direct_lpips = false;
  transmission.lambda_plausible = transmission.lambda_transparency_prior = 0;
  config.densify.until = 30000;
  config.densify.slow_interval = config.densify.min_surfels = 0;
  config.densify.min_opacity = 0.05f;
  config.densify.scale_limit = 0;
  config.reflection_gradient = 1e-4f;
  config.reflection_quantile = 0;
  config.secondary_run_clock = config.run_clock_rates = false;
  config.secondary_densify_interval = 100;
  config.secondary_reset_interval = 3000;
  config.reset_secondary = config.reset_transparency = false;
  config.transmission_min_opacity = -1;
  config.transmission_min_share = config.reflection_min_share = 0;
  config.secondary_prune_light_large = false;
  config.secondary_scale_limit = 0;
  config.rates.means_steps = 60000;
  config.freeze_at_least = 10000;
  config.mirror.observe_every = 0;
}

// docs/design/glint.md has what each does alone.
void set_plus(GlintConfig& config) {
  set_text(config);
  // Both secondary sets start as copies of the interface, and a quarter of the resets.
  config.clone_interface = config.clone_reflection = true;
  config.densify.reset_interval = 12000;
  // The row's weights of photos and geometry.
  const GlintConfig row;
  config.l1_weight = row.l1_weight;
  config.ssim_weight = row.ssim_weight;
  config.geometry = row.geometry;
  config.geometry.cosine_consistency = false;
  config.geometry.unit_consistency = true;
  // The row's growth, by rays of their own.
  config.densify.until = row.densify.until;
  config.densify.slow_interval = row.densify.slow_interval;
  config.densify.min_opacity = row.densify.min_opacity;
  config.transmission_min_opacity = row.transmission_min_opacity;
  config.mirror.observe_every = row.mirror.observe_every;
  // Mirrors and panes show what the camera behind their plane sees; a pane has two faces.
  config.plane_mirrors = true;
  config.glass_f0 = 2 * kGlassF0;
  // So mirrored windows may teach what is brighter than white.
  config.clip_at_white = true;
  // The transmission set alone is held to the photos, less than in the row.
  config.transmission_losses.lambda_direct = 0.3f;
  config.transmission_losses.lambda_direct_consistency = 0.1f;
  // Once the sets are grown, rates fall: what is left of the run averages over views and noise.
  config.rates.settled = 0.03f;
  config.freeze = "nothing";
}

void set_nested(GlintConfig& config, int layers) {
  set_plus(config);
  config.layers = layers;
}

void set_oracle(GlintConfig& config) {
  config.oracle = true;
  TransmissionLossConfig& losses = config.transmission_losses;
  losses.lambda_transparency = losses.lambda_transparency_prior = losses.lambda_plausible = 0;
}

}  // namespace glint
