// SPDX-License-Identifier: MIT
// Settings of GLINT [Na26]. Defaults follow the paper's text and, where that is silent, the present
// state of the official code (V2: the second release): docs/design/glint.md has the values with
// their sources. Iterations are of the published 60,000 and scale with the run.
#pragma once

#include <string>

#include "glint/render/transport.h"
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

  bool at(int iteration) const {
    return lambda > 0 && iteration >= from && iteration < until && iteration % every == 0;
  }
};

// What visit() names can be set by users; the rest differs between variants, or nowhere.
struct GlintConfig {
  // Radiance transport.
  bool with_transmission = true, with_reflection = true;
  std::string transmission = "raster";
  bool linear_light = false;        // beyond the paper
  bool detach_transparency = true;  // no gradient of t to where surfels are and how opaque
  bool oracle = false;              // depth, normal and t of the interface are the true ones
  float secondary_near = 0;
  int layers = 1;  // surfaces along the straight ray that let light through and mirror it
  float layer_gap = 0.05f, pane_gap = 0.4f;  // metres, LayersCall
  MirrorCutoffs mirror;
  bool plane_mirrors = false;  // and panes: looks for them once guidance of t begins
  float glass_f0 = kGlassF0;   // what glass mirrors along its normal; the paper: as one face does
  bool clip_at_white = false;  // where a photo is white, a brighter picture is no error
  // Initial sets.
  float initial_transparency = 0.01f, initial_specular = 1e-3f;
  float reflection_opacity = 0.1f;
  int random_points = 30000;  // of scenes without points
  ReflectionGrid grid;
  // Phases.
  int transmission_from = 5000, reflection_from = 5000, freeze_from = 40000, sh_interval = 1000;
  std::string freeze = "all";
  int freeze_at_least = 0;  // steps of any run before anything is frozen
  // Losses.
  float l1_weight = 1.2f, ssim_weight = 0.4f;
  MultiViewConfig multi_view;
  PerceptualConfig perceptual;
  GeometryLossConfig geometry;
  TransmissionLossConfig transmission_losses;
  // Density control.
  DensifyConfig densify;
  float transmission_gradient = 2e-4f, reflection_gradient = 2e-4f;
  float reflection_quantile = 0.95f;  // gradient_quantile of the reflection set
  // Density control of secondary sets counts steps of the run, not their own.
  bool secondary_run_clock = true;
  int secondary_densify_interval = 500, secondary_reset_interval = 6000;
  bool reset_secondary = true;
  bool reset_transparency = true;  // to its start, in the interface's opacity resets
  bool clone_interface = false, clone_reflection = false;
  float transmission_min_opacity = 0.05f;  // below 0: min_opacity
  float transmission_min_share = 0.01f, reflection_min_share = 0.05f;
  bool secondary_prune_light_large = true;
  float secondary_scale_limit = 2;
  SurfelRates rates;
  float rate_transparency = 0.05f;  // as the official code has them, in runs of any length
  float rate_specular = 0.01f;
  bool run_clock_rates = true;  // as secondary_run_clock, of harmonics and positions

  GlintConfig();

  template <class V>
  void visit(V&& v) {
    v("with_transmission", with_transmission, "false: t counts as 0");
    v("with_reflection", with_reflection, "false: k_s counts as 0");
    v("transmission", transmission, "raster or trace");
    v("linear_light", linear_light, "layers are added as linear, not as displayed values");
    v("secondary_near", secondary_near, "metres behind the interface where transmission starts");
    v("layers", layers, "surfaces along a ray that let light through and mirror it; paper: 1");
    mirror.visit(v);
    v("initial_transparency", initial_transparency, "t of the interface's initial surfels");
    grid.visit(v);
    v("transmission_from", transmission_from, "first iteration of transmission (of 60,000)");
    v("reflection_from", reflection_from, "first iteration of reflection (of 60,000)");
    v("freeze_from", freeze_from, "first iteration with a frozen interface (of 60,000)");
    v("freeze", freeze, "what is frozen of the interface: all, geometry or nothing");
    v("sh_interval", sh_interval, "iterations per SH degree (of 60,000)");
    v("l1_weight", l1_weight, "weight of L1");
    v("ssim_weight", ssim_weight, "weight of 1 - SSIM");
    v("lambda_multi_view", multi_view.lambda, "weight of the losses of two views; 0: none");
    perceptual.visit(v);
    geometry.visit(v);
    transmission_losses.visit(v);
    densify.visit(v);
    v("densify_slow_interval",
      densify.slow_interval,
      "steps between densifications of the interface in the middle of a run; 0: as ever");
    visit_secondary(v);
    rates.visit(v);
    rates.visit_settling(v);
    v("rate_transparency", rate_transparency, "learning rate of transparency");
    v("rate_specular", rate_specular, "learning rate of specularity");
  }
  // Density control of the secondary sets.
  template <class V>
  void visit_secondary(V&& v) {
    v("transmission_gradient", transmission_gradient, "threshold of the transmission set");
    v("reflection_gradient", reflection_gradient, "threshold of the reflection set");
    v("secondary_densify_interval", secondary_densify_interval, "steps, of secondary sets");
    v("secondary_reset_interval", secondary_reset_interval, "steps, of secondary sets");
    v("reset_secondary", reset_secondary, "opacity resets of transmission and reflection too");
    v("clone_interface", clone_interface, "transmission starts as a copy of the interface");
    v("clone_reflection", clone_reflection, "reflection starts as a copy of the interface");
  }

  static constexpr int kPublishedIterations = 60000;
  // With the windows of a run of so many iterations.
  GlintConfig scaled_to(int iterations) const;
  // Of the three sets, in a run's windows; the secondary sets count steps from where they start,
  // if not by secondary_run_clock.
  DensifyConfig interface_densify() const;
  DensifyConfig transmission_densify() const;
  DensifyConfig reflection_densify(ImageSize size) const;  // of training images
  // Of a secondary set that starts at `from`.
  SurfelRates secondary_rates(int from) const;
  // Errors (kUsage): a word that is none of the known ones. Numbers: setting_ranges.h.
  void check() const;

 private:
  DensifyConfig secondary_densify() const;
};

// Variants. What the official code does instead of the paper, without its mistakes.
void set_release(GlintConfig& config);
// What was called GLINT here before: the paper, and our own values where it is silent.
void set_text(GlintConfig& config);
// Beyond the paper.
void set_plus(GlintConfig& config);
// GLINT+ with so many layers.
void set_nested(GlintConfig& config, int layers);
// With the true interface.
void set_oracle(GlintConfig& config);

}  // namespace glint
