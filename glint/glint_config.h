// SPDX-License-Identifier: MIT
// Settings of GLINT [Na26]. Defaults follow the paper's text; what it leaves open is chosen here:
// docs/GLINT_NOTES.md, "What the paper leaves open". Iterations are of the published 60,000 and
// scale with the run.
#pragma once

#include <string>

#include "glint/train/densify.h"
#include "glint/train/geometry_losses.h"
#include "glint/train/initial_points.h"
#include "glint/train/mirror_cutoffs.h"
#include "glint/train/perceptual.h"
#include "glint/train/reflection_bootstrap.h"
#include "glint/train/transmission_losses.h"

namespace glint {

struct GlintConfig {
  // Radiance transport.
  bool with_transmission = true, with_reflection = true;
  std::string transmission = "raster";
  float f0 = 0.04f;
  bool linear_light = false;  // beyond the paper
  bool detach_origins = true;
  float secondary_near = 0;
  MirrorCutoffs mirror;
  // Initial sets.
  float initial_transparency = 0.1f, initial_specular = 1e-3f;
  float reflection_opacity = 0.1f;
  int random_points = 30000;
  ReflectionGrid grid;
  // Phases.
  int transmission_from = 5000, reflection_from = 5000, freeze_from = 40000, sh_interval = 1000;
  std::string freeze = "all";
  int freeze_at_least = 10000;
  // Losses.
  float l1_weight = 0.8f, ssim_weight = 0.2f;
  PerceptualConfig perceptual;
  GeometryLossConfig geometry;
  TransmissionLossConfig transmission_losses;
  // Density control.
  DensifyConfig densify;
  float transmission_gradient = 2e-4f, reflection_gradient = 1e-4f;
  bool transmission_weighted_views = true;
  bool secondary_run_clock = false;
  int secondary_densify_interval = 100, secondary_reset_interval = 3000;
  // Opacity resets of the secondary sets. Off: their gradient is weighted by t and k_s, so most of
  // their surfels would not recover before the next pruning.
  bool reset_secondary = false;
  // As the official code does: t and s back to what they start with in the interface's opacity
  // resets (s not before reflection takes part), the transmission set from a copy of the interface,
  // and what helps s and t along.
  bool reset_channels = false, clone_interface = false;
  float transmission_min_opacity = -1;
  int secondary_max_surfels = 0;
  BootstrapConfig bootstrap;
  SurfelRates rates;
  float rate_transparency = 0.05f;  // as the official code has them, in runs of any length
  float rate_specular = 0.01f;

  GlintConfig();

  template <class V>
  void visit(V&& v) {
    v("with_transmission", with_transmission, "false: t counts as 0");
    v("with_reflection", with_reflection, "false: k_s counts as 0");
    v("transmission", transmission, "raster or trace");
    v("f0", f0, "reflectance at normal incidence");
    v("linear_light", linear_light, "layers are added as linear, not as displayed values");
    v("detach_origins", detach_origins, "no gradient from reflections to the interface's depth");
    v("secondary_near", secondary_near, "metres behind the interface where transmission starts");
    mirror.visit(v);
    v("initial_transparency", initial_transparency, "t of the interface's initial surfels");
    v("initial_specular", initial_specular, "s of the interface's initial surfels");
    v("reflection_opacity", reflection_opacity, "opacity of the reflection set's initial surfels");
    v("random_points", random_points, "initial surfels of scenes without points");
    grid.visit(v);
    v("transmission_from", transmission_from, "first iteration of transmission (of 60,000)");
    v("reflection_from", reflection_from, "first iteration of reflection (of 60,000)");
    v("freeze_from", freeze_from, "first iteration with a frozen interface (of 60,000)");
    v("freeze", freeze, "what is frozen of the interface: all, geometry or nothing");
    v("freeze_at_least", freeze_at_least, "steps of any run before anything is frozen");
    v("sh_interval", sh_interval, "iterations per SH degree (of 60,000)");
    v("l1_weight", l1_weight, "weight of L1");
    v("ssim_weight", ssim_weight, "weight of 1 - SSIM");
    perceptual.visit(v);
    geometry.visit(v);
    transmission_losses.visit(v);
    densify.visit(v);
    rates.visit(v);
    v("rate_transparency", rate_transparency, "learning rate of transparency");
    v("rate_specular", rate_specular, "learning rate of specularity");
    v("transmission_gradient", transmission_gradient, "threshold of the transmission set");
    v("secondary_run_clock",
      secondary_run_clock,
      "density control of secondary sets counts steps of the run, not their own");
    v("transmission_weighted_views",
      transmission_weighted_views,
      "its mean gradient is over views with weight of it, as where it is traced");
    v("reflection_gradient", reflection_gradient, "densification threshold of the reflection set");
    v("secondary_densify_interval", secondary_densify_interval, "steps, of secondary sets");
    v("secondary_reset_interval", secondary_reset_interval, "steps, of secondary sets");
    v("reset_secondary", reset_secondary, "opacity resets of transmission and reflection too");
    v("reset_channels", reset_channels, "opacity resets of the interface reset t and s, too");
    v("clone_interface", clone_interface, "transmission starts as a copy of the interface");
    v("transmission_min_opacity",
      transmission_min_opacity,
      "min_opacity of the transmission set; below 0: min_opacity");
    v("secondary_max_surfels",
      secondary_max_surfels,
      "max_surfels of each of the secondary sets; 0: max_surfels");
    bootstrap.visit(v);
  }

  static constexpr int kPublishedIterations = 60000;
  // With the windows of a run of so many iterations.
  GlintConfig scaled_to(int iterations) const;
  // Of the three sets, in a run's windows; the secondary sets count steps from where they start,
  // if not by secondary_run_clock.
  DensifyConfig interface_densify(std::size_t training_views) const;
  DensifyConfig transmission_densify() const;
  DensifyConfig reflection_densify(ImageSize size) const;  // of training images
  // Errors (kUsage): a word that is none of the known ones. Numbers: setting_ranges.h.
  void check() const;

 private:
  DensifyConfig secondary_densify() const;
};

// What the official code does beyond or instead of the paper, without its mistakes.
Json glint_release_overrides();

}  // namespace glint
