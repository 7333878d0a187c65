// SPDX-License-Identifier: MIT
// How a set with a specularity s is made to leave reflections to an environment [Ye24b, Xie25]:
// "3D Gaussian Splatting with Deferred Reflection", SIGGRAPH 2024. Both act between steps, every
// `interval` steps:
// - colour sabotage: the colour of surfels that mirror little gets noise, so that those which
//   mirror are the quicker ones to explain what is seen;
// - normal propagation: all surfels become opaque, and those that mirror grow, so that their
//   normals, which are good, cover their neighbours'. Opacities then stay for a while.
#pragma once

#include "glint/core/rng.h"
#include "glint/train/trainable_set.h"

namespace glint {

struct BootstrapConfig {
  bool color_sabotage = false, normal_propagation = false;
  int from = 3000, until = 18000, interval = 1000;  // steps; `from` is exclusive
  int opacity_pause = 200;                          // steps
  float sabotage_range = 0.4f;                      // of the noise on the SH coefficient 0
  float sabotage_below = 0.05f;
  float raised_opacity = 0.9f;
  float enlarge = 1.5f, enlarge_above = 0.02f;

  template <class V>
  void visit(V&& v) {
    v("color_sabotage", color_sabotage, "noise on the colour of surfels that mirror little");
    v("normal_propagation", normal_propagation, "surfels become opaque, mirroring ones grow");
    v("bootstrap_from", from, "published step after which both begin");
    v("bootstrap_until", until, "last published step of both");
    v("bootstrap_interval", interval, "published steps between them");
    v("opacity_pause", opacity_pause, "published steps without change of opacity after a growth");
    v("sabotage_range", sabotage_range, "largest noise on SH coefficient 0");
    v("sabotage_below", sabotage_below, "surfels with no extra channel above get the noise");
    v("propagation_opacity", raised_opacity, "opacity that surfels are raised to");
    v("propagation_scale", enlarge, "factor of the scales of mirroring surfels");
    v("propagation_above", enlarge_above, "specularity from which surfels grow");
  }
  // Published windows to this run's steps; scaled(published, at least).
  // Deviation: not more often than every 100 steps, a third of the least time between opacity
  // resets (as published), for a colour takes about that long to recover.
  template <class F>
  void scale(F&& scaled) {
    for (int* window : {&from, &until}) *window = scaled(*window, 1);
    interval = scaled(interval, 100);
    opacity_pause = scaled(opacity_pause, 20);
  }
};

class ReflectionBootstrap {
 public:
  ReflectionBootstrap() = default;
  ReflectionBootstrap(const BootstrapConfig& config, std::uint64_t seed);

  // Call after set.update(step). Does what is due, unless opacities are reset in this step.
  // Errors (kUsage): normal propagation of a set without a channel "specular".
  void update(int step, TrainableSet& set);

  template <class State>
  void visit_state(State& state) {
    state("rng", rng_);
  }

 private:
  BootstrapConfig config_;
  Rng rng_{0};
};

// Uniform noise in [-range, range] on SH coefficient 0 of the surfels all of whose extra channels
// are at most `below`; the optimiser forgets the array's moments.
void sabotage_colors(float range, float below, Rng& rng, SurfelCloud& cloud, SurfelAdam& optimiser);

// Opacities below `opacity` rise to it, scales of surfels whose channel "specular" is at least
// `above` are multiplied; the optimiser forgets the moments of both. Errors (kUsage): no such
// channel.
void propagate_normals(
    float opacity, float enlarge, float above, SurfelCloud& cloud, SurfelAdam& optimiser
);

}  // namespace glint
