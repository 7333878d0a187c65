// SPDX-License-Identifier: MIT
// Adam [Kingma15] over the arrays of a surfel cloud, one rate per array, and the position schedule.
#pragma once

#include <vector>

#include "glint/scene/surfels.h"

namespace glint {

// What rates are multiplied by in a run that is `shortening` times shorter than the published one:
// the fourth root, at least 1.
float faster_rates(double shortening);

// Learning rates of the parameter arrays [Huang24, Kerbl23]. Positions:
// log-linear from `means` to `means_final` over `means_steps` steps, both times the scene's extent.
struct SurfelRates {
  float means = 1.6e-4f, means_final = 1.6e-6f;
  int means_steps = 30000;
  float sh_dc = 2.5e-3f;
  float sh_rest = 2.5e-3f / 20;
  float opacity = 0.05f;
  float scale = 0.005f;
  float rotation = 0.001f;
  // Beyond the papers: all rates but the positions' fall log-linearly to a share of themselves, so
  // that the end of a run averages over views and their noise. 1: they do not.
  float settled = 1;
  int settle_from = 15000, settle_until = 30000;
  std::vector<float> extra;  // of the set's extra channels, in their order
  int first_step = 0;        // of the run, of Adam's first
  bool run_clock = true;     // positions slow down by steps of the run, not by Adam's

  template <class V>
  void visit(V&& v) {
    v("rate_position", means, "learning rate of positions, of the scene's extent");
    v("rate_position_final", means_final, "the same after position_steps, above 0");
    v("position_steps", means_steps, "published steps over which positions slow down");
    v("rate_color", sh_dc, "learning rate of colour");
    v("rate_sh", sh_rest, "learning rate of view-dependent colour");
    v("rate_opacity", opacity, "learning rate of opacity");
    v("rate_scale", scale, "learning rate of log scales");
    v("rate_rotation", rotation, "learning rate of quaternions");
  }
  template <class V>
  void visit_settling(V&& v) {
    v("rate_settled", settled, "share to which all rates but the positions' fall; 1: none");
    v("settle_from", settle_from, "published step from which they fall");
    v("settle_until", settle_until, "published step at which they have fallen");
  }

  // Rates of a run that is `shortening` times shorter than the published one: numbers of steps
  // shrink with it, and positions, colour, scales and rotations move faster by faster_rates(), the
  // same rule for every method. Deviation: at published rates a short run ends before
  // surfels have reached their place (docs/design/baselines.md).
  SurfelRates for_shorter_run(double shortening) const;
};

// The rate of a step of `steps`: log-linear from `begin` to `end`, `end` behind; 0 where `begin` is
// 0. Errors (kUsage): one of them is not above 0 otherwise.
float log_linear_rate(float begin, float end, int step, int steps);
// What the other rates are multiplied by at a step of the run; errors: as above.
float settled_share(const SurfelRates& rates, int step);
// Rate of the positions at a step, before the factor of the scene's extent; errors: as above.
float position_rate(const SurfelRates& rates, int step);

class SurfelAdam {
 public:
  // One step; sets `gradient` back to zero. All clouds have the same size. Errors (kUsage): not one
  // rate for every extra channel, or too many of them.
  void step(SurfelCloud& cloud, SurfelCloud& gradient, const SurfelRates& rates, float extent);

  // Rows follow those of the cloud: moments of kept rows stay, new rows start at zero.
  SurfelCloud& first() { return first_; }
  SurfelCloud& second() { return second_; }
  int steps() const { return steps_; }

  template <class State>
  void visit_state(State& state) {
    state("first", first_);
    state("second", second_);
    state("steps", steps_);
  }

 private:
  SurfelCloud first_, second_;
  int steps_ = 0;
};

}  // namespace glint
