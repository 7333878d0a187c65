// SPDX-License-Identifier: MIT
#include "glint/glint_config.h"

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
  geometry.lambda_smooth = 0.01f;
  geometry.smooth_from = 5000;
  densify.until = 30000;
  rates.means_steps = kPublishedIterations;
}

GlintConfig GlintConfig::scaled_to(int iterations) const {
  GlintConfig run = *this;
  const auto scaled = [&](int published, int at_least = 1) {
    return scaled_step(published, iterations, at_least, kPublishedIterations);
  };
  for (int* window :
       {&run.transmission_from,
        &run.reflection_from,
        &run.sh_interval,
        &run.perceptual.lpips_from,
        &run.densify.from,
        &run.densify.until})
    *window = scaled(*window);
  // Deviation: in short runs the interface has not converged by two thirds of them, and freezing it
  // there costs quality; it trains for as many steps as it takes, or to the end.
  run.freeze_from = scaled(freeze_from, freeze_at_least);
  run.rates = rates.for_shorter_run(static_cast<double>(kPublishedIterations) / iterations);
  run.geometry.scale(scaled);
  run.transmission_losses.scale(scaled);
  run.densify.interval = scaled(densify.interval, 50);
  run.secondary_densify_interval = scaled(secondary_densify_interval, 50);
  run.densify.reset_interval = scaled(densify.reset_interval, 300);
  run.secondary_reset_interval = scaled(secondary_reset_interval, 300);
  if (!with_transmission) run.transmission_losses.lambda_transparency = 0;
  return run;
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
}

Json glint_release_overrides() {
  return Json{
      {"detach_origins", true},
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
      {"lambda_smooth", 0.05},
      {"guidance", "release"},
      {"lambda_transparency", 0.01},
      {"transparency_from", 5000},
      {"depth_threshold", 0.005},
      {"lambda_direct", 1.0},
      {"lambda_plausible", 0.05},
      {"lambda_transparency_prior", 0.01},
      {"densify_until", 21000},
      {"position_steps", 30000},
      {"min_opacity", 0.08},
      {"reflection_gradient", 2e-4},
      {"secondary_densify_interval", 500},
      {"secondary_reset_interval", 6000},
      {"reset_secondary", true},
  };
}

}  // namespace glint
