// SPDX-License-Identifier: MIT
// Settings of GLINT [Na26]. Defaults follow the paper's text and, where that is silent, the present
// state of the official code (V2: the second release): docs/GLINT_NOTES.md has the values with
// their sources. Iterations are of the published 60,000 and scale with the run.
#pragma once

#include <string>

#include "glint/train/densify.h"
#include "glint/train/geometry_losses.h"
#include "glint/train/initial_points.h"
#include "glint/train/mirror_cutoffs.h"
#include "glint/train/neighbor_views.h"
#include "glint/train/perceptual.h"
#include "glint/train/transmission_losses.h"

namespace glint {

// Every so many steps of a window, the interface agrees with a neighbouring view in depth and,
// warped by its planes, in the photos (planar_losses.h).
struct MultiViewConfig {
  float lambda = 0.01f, geometric = 0.03f, photometric = 0.15f;
  int every = 10, from = 10000, until = 21000;
  NeighborConfig neighbors;

  template <class V>
  void visit(V&& v) {
    v("lambda_multi_view", lambda, "weight of the losses of two views; 0: none");
    v("multi_view_geometric", geometric, "of the reprojection error among them");
    v("multi_view_photometric", photometric, "of 1 - NCC^2 of patches among them");
    v("multi_view_every", every, "steps from one of them to the next");
    v("multi_view_from", from, "first published iteration of these");
    v("multi_view_until", until, "last published iteration of these, exclusive");
    neighbors.visit(v);
  }
  bool at(int iteration) const {
    return lambda > 0 && iteration >= from && iteration < until && iteration % every == 0;
  }
};

struct GlintConfig {
  // Radiance transport.
  bool with_transmission = true, with_reflection = true;
  std::string transmission = "raster";
  float f0 = 0.04f;
  bool linear_light = false;  // beyond the paper
  bool detach_origins = true;
  bool detach_transparency = true;  // no gradient of t to where surfels are and how opaque
  bool oracle = false;              // depth, normal and t of the interface are the true ones
  float secondary_near = 0;
  float quiet_below = 0;  // beyond the paper
  MirrorCutoffs mirror;
  // Initial sets.
  float initial_transparency = 0.01f, initial_specular = 1e-3f;
  float reflection_opacity = 0.1f;
  int random_points = 30000;
  ReflectionGrid grid;
  // Phases.
  int transmission_from = 5000, reflection_from = 5000, freeze_from = 40000, sh_interval = 1000;
  std::string freeze = "all";
  int freeze_at_least = 0;
  // Losses.
  float l1_weight = 1.2f, ssim_weight = 0.4f;
  bool clipped_photos = false;  // beyond the paper
  MultiViewConfig multi_view;
  PerceptualConfig perceptual;
  GeometryLossConfig geometry;
  TransmissionLossConfig transmission_losses;
  // Density control.
  DensifyConfig densify;
  float transmission_gradient = 2e-4f, reflection_gradient = 2e-4f;
  float reflection_quantile = 0.95f;
  bool transmission_weighted_views = true;
  bool secondary_run_clock = true;
  int secondary_densify_interval = 500, secondary_reset_interval = 6000;
  bool reset_secondary = true;
  // t and s back to what they start with in the interface's opacity resets (s not before reflection
  // takes part), and secondary sets from a copy of the interface.
  bool reset_transparency = true, reset_specular = false;
  bool clone_interface = false, clone_reflection = false;
  float transmission_min_opacity = 0.05f;
  float transmission_min_share = 0.01f, reflection_min_share = 0.05f;
  bool secondary_prune_light_large = true;
  float secondary_scale_limit = 2;
  SurfelRates rates;
  float rate_transparency = 0.05f;  // as the official code has them, in runs of any length
  float rate_specular = 0.01f;
  bool run_clock_rates = true;
  float reflection_color_rate = 1;  // beyond the paper

  GlintConfig();

  template <class V>
  void visit(V&& v) {
    v("with_transmission", with_transmission, "false: t counts as 0");
    v("with_reflection", with_reflection, "false: k_s counts as 0");
    v("transmission", transmission, "raster or trace");
    v("f0", f0, "reflectance at normal incidence");
    v("linear_light", linear_light, "layers are added as linear, not as displayed values");
    v("detach_origins", detach_origins, "no gradient from reflections to the interface's depth");
    v("detach_transparency",
      detach_transparency,
      "no gradient of t to the interface's geometry and opacity");
    v("oracle", oracle, "depth, normal and t of the interface are the true ones: no rival");
    v("secondary_near", secondary_near, "metres behind the interface where transmission starts");
    v("quiet_below",
      quiet_below,
      "share of a pixel below which interface and transmission get no gradient from its colour");
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
    v("clipped_photos", clipped_photos, "where a photo is white, being brighter is no error");
    multi_view.visit(v);
    perceptual.visit(v);
    geometry.visit(v);
    transmission_losses.visit(v);
    densify.visit(v);
    rates.visit(v);
    visit_secondary(v);
  }
  // Rates of channels and sets, and density control of the secondary sets.
  template <class V>
  void visit_secondary(V&& v) {
    v("rate_transparency", rate_transparency, "learning rate of transparency");
    v("rate_specular", rate_specular, "learning rate of specularity");
    v("run_clock_rates",
      run_clock_rates,
      "harmonics and positions of secondary sets count steps of the run, not their own");
    v("reflection_color_rate", reflection_color_rate, "factor on the reflection set's colour rates"
    );
    v("transmission_gradient", transmission_gradient, "threshold of the transmission set");
    v("reflection_quantile", reflection_quantile, "gradient_quantile of the reflection set");
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
    v("reset_transparency", reset_transparency, "opacity resets of the interface reset t, too");
    v("reset_specular", reset_specular, "opacity resets of the interface reset s, too");
    v("clone_interface", clone_interface, "transmission starts as a copy of the interface");
    v("clone_reflection", clone_reflection, "reflection starts as a copy of the interface");
    v("transmission_min_share", transmission_min_share, "min_share of the transmission set");
    v("reflection_min_share", reflection_min_share, "min_share of the reflection set");
    v("secondary_prune_light_large",
      secondary_prune_light_large,
      "prune_light_large of the secondary sets");
    v("secondary_scale_limit", secondary_scale_limit, "scale_limit of the secondary sets");
    v("transmission_min_opacity",
      transmission_min_opacity,
      "min_opacity of the transmission set; below 0: min_opacity");
  }

  static constexpr int kPublishedIterations = 60000;
  // With the windows of a run of so many iterations.
  GlintConfig scaled_to(int iterations) const;
  // Of the three sets, in a run's windows; the secondary sets count steps from where they start,
  // if not by secondary_run_clock.
  DensifyConfig interface_densify(std::size_t training_views) const;
  DensifyConfig transmission_densify() const;
  DensifyConfig reflection_densify(ImageSize size) const;  // of training images
  // Of a secondary set that starts at `from`, and of the reflection set.
  SurfelRates secondary_rates(int from) const;
  SurfelRates reflection_rates() const;
  // Errors (kUsage): a word that is none of the known ones. Numbers: setting_ranges.h.
  void check() const;

 private:
  DensifyConfig secondary_densify() const;
};

// What the official code does instead of the paper, without its mistakes.
Json glint_release_overrides();
// What was called GLINT here before: the paper, and our own values where it is silent.
Json glint_text_overrides();
// Beyond the paper.
Json glint_plus_overrides();
// With the true interface.
Json glint_oracle_overrides();

}  // namespace glint
