// SPDX-License-Identifier: MIT
// Training of planar surfels [Chen24]: one set, the photometric loss, the losses of planes, density
// control with its trim. What methods that build on it differ in, they add between its calls.
#pragma once

#include "glint/train/photometric.h"
#include "glint/train/planar_losses.h"
#include "glint/train/trainer.h"

namespace glint {

class LobeAppearance;

struct PlanarConfig {
  float lambda_ssim = 0.2f;  // (1 - lambda) L1 + lambda (1 - SSIM)
  int sh_interval = 1000;    // one degree more each
  int random_points = 30000;
  float initial_opacity = 0.1f;
  int trim_interval = 1000, trim_until = 15000;
  PlanarLossConfig planes;
  DensifyConfig densify;
  SurfelRates rates;

  PlanarConfig();
  template <class V>
  void visit(V&& v) {
    v("lambda_ssim", lambda_ssim, "weight of 1 - SSIM against L1");
    v("sh_interval", sh_interval, "iterations per SH degree (of 30,000)");
    v("random_points", random_points, "initial surfels of scenes without points");
    v("initial_opacity", initial_opacity, "of the initial surfels");
    v("trim_interval", trim_interval, "steps between trims of what too few views see");
    v("trim_until", trim_until, "last step of trims, exclusive");
    planes.visit(v);
    densify.visit(v);
    v("max_abs_splits",
      densify.max_abs_splits,
      "splits by absolute gradient a densification; 0: none");
    v("abs_gradient", densify.abs_gradient, "mean absolute NDC gradient that splits large surfels");
    v("abs_radius_px",
      densify.abs_radius_px,
      "radius that counts as large, pixels at the reference rows");
    v("min_observations",
      densify.min_observations,
      "views that must see a surfel, where sets are trimmed");
    rates.visit(v);
  }
  // Windows of this run.
  void scale_to(int iterations);
};

class PlanarModel {
 public:
  explicit PlanarModel(TrainableSet& set) : set_(set) {}  // is borrowed

  // `published` with windows of 30,000 iterations, which are scaled to the run's. Returns warnings.
  std::vector<std::string> set_up(
      const PlanarConfig& published,
      const Scene& scene,
      const RunOptions& options,
      const std::string& method
  );

  // A step: forward() renders the next training view, losses are added to gradient() by add_losses
  // and by the method, backward() makes the step of the optimiser and of density control.
  const View& forward(int iteration, StepStats& stats);
  // target: the picture that the render is compared with, [H][W][3].
  void add_losses(const Photo& photo, StepStats& stats);
  void backward(StepStats& stats);

  // From now on their offsets are added to the colours of training views, render() and draw(), and
  // backward() gives them their gradients; the step of their optimiser is the caller's. They are
  // borrowed, and the surfels must stay the same ones. Null: SH alone.
  void add_lobes(LobeAppearance* lobes) { lobes_ = lobes; }

  const RasterOutput& output() const { return *output_; }  // of the last forward() or draw()
  RasterOutputGradient& gradient() { return gradient_; }
  const PlanarConfig& windows() const { return windows_; }
  // Metres that a published scene unit stands for.
  float scene_unit() const { return windows_.planes.neighbors.unit * scene_->spatial_scale; }

  // "rgb", "depth" (of planes), "normal". The output stays valid until the next call.
  MapSet render(const Camera& camera);
  const RasterOutput& draw(const Camera& camera);

  void use_all_degrees() { sh_degree_ = 3; }  // of a set that was loaded
  template <class State>
  void visit_state(State& state) {
    state("views", views_);
  }

 private:
  void rasterize(const Camera& camera, const RasterSettings& settings);
  void trim(int step);

  PlanarConfig windows_;
  const Scene* scene_ = nullptr;
  TrainableSet& set_;
  LobeAppearance* lobes_ = nullptr;
  ViewSampler views_;
  std::size_t view_ = 0;  // of this step
  int sh_degree_ = 3;
  PlanarLosses planes_;
  PhotometricLoss photometric_;
  const RasterOutput* output_ = nullptr;
  RasterOutputGradient gradient_;
};

}  // namespace glint
