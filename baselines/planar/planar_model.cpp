// SPDX-License-Identifier: MIT
#include "baselines/planar/planar_model.h"

#include <algorithm>

#include "baselines/planar/lobe_appearance.h"
#include "glint/render/map_ops.h"
#include "glint/train/initial_points.h"

namespace glint {

PlanarConfig::PlanarConfig() {
  densify.clone_scale = 0.001f;
  densify.sample_clones = true;
}

void PlanarConfig::scale_to(int iterations) {
  const auto scaled = [&](int published, int at_least = 1) {
    return scaled_step(published, iterations, at_least);
  };
  for (int* window : {&sh_interval, &planes.from, &trim_until}) *window = scaled(*window);
  trim_interval = scaled(trim_interval, 100);
  densify.scale(scaled);
  rates = rates.for_shorter_run(30000.0 / iterations);
}

std::vector<std::string> PlanarModel::set_up(
    const PlanarConfig& published,
    const Scene& scene,
    const RunOptions& options,
    const std::string& method
) {
  scene_ = &scene;
  windows_ = published;
  windows_.scale_to(options.iterations);
  std::vector<std::string> warnings = planes_.set_up(windows_.planes, scene, options.seed, method);
  warn_without_points(scene, method, warnings);
  InitialSurfels initial;
  initial.opacity = windows_.initial_opacity;
  initial.seed = options.seed;
  const PointCloud points = initial_points(scene, windows_.random_points, options.seed);
  set_ = TrainableSet(points, initial, training_on(scene, windows_.rates, windows_.densify));
  views_ = ViewSampler(scene.train.size(), options.seed);
  return warnings;
}

const View& PlanarModel::forward(int iteration, StepStats& stats) {
  stats.iteration = iteration;
  view_ = views_.next();
  const View& view = scene_->train[view_];
  sh_degree_ = std::min(3, iteration / windows_.sh_interval);
  RasterSettings settings;
  settings.with_plane_distance = iteration >= windows_.planes.from;
  settings.with_statistics = windows_.densify.max_abs_splits > 0;
  settings.screen_with_low_pass = true;
  rasterize(view.camera, settings);
  clear_gradient(view.camera.size(), output_->features.channels(), gradient_);
  if (settings.with_plane_distance) clear_image(gradient_.plane_distance, view.camera.size(), 1);
  return view;
}

void PlanarModel::add_losses(const Photo& photo, StepStats& stats) {
  const PhotometricWeights weights{1 - windows_.lambda_ssim, windows_.lambda_ssim};
  const PhotometricTerms terms =
      photometric_.evaluate(output_->features, photo, weights, gradient_.features);
  stats.terms["photometric"] = terms.weighted(weights);
  stats.psnr = terms.psnr();
  planes_.add(view_, stats.iteration, set_, *output_, gradient_, stats);
}

void PlanarModel::backward(StepStats& stats) {
  for (const auto& [name, value] : stats.terms) stats.loss += value;
  RasterPass& pass = set_.pass();
  const RasterGradient& gradient = set_.backward(gradient_, pass, true);
  if (lobes_ != nullptr) lobes_->backward(gradient, pass.activated.channels);
  trim(stats.iteration + 1);  // before a reset, which would show what is hidden
  note_reset(set_.update(stats.iteration + 1), "", stats);
  stats.num_surfels = set_.cloud().size();
}

void PlanarModel::trim(int step) {
  if (step >= windows_.trim_until || step % windows_.trim_interval != 0) return;
  std::vector<Camera> cameras;
  for (const View& view : scene_->train) cameras.push_back(view.camera);
  set_.trim(cameras);
}

MapSet PlanarModel::render(const Camera& camera) {
  const RasterOutput& out = draw(camera);
  MapSet maps;
  plane_depth_map(camera, out.plane_distance, out.normal, maps["depth"]);
  maps["normal"] = unit_normals(out.normal);
  add_depth_estimates(out, maps);
  copy_color(out.features, maps["rgb"]);
  return maps;
}

const RasterOutput& PlanarModel::draw(const Camera& camera) {
  RasterSettings settings;
  settings.with_plane_distance = true;
  rasterize(camera, settings);
  return *output_;
}

void PlanarModel::rasterize(const Camera& camera, const RasterSettings& settings) {
  set_.pass().activated.options.color_offsets =
      lobes_ != nullptr ? &lobes_->forward(set_.cloud(), camera) : nullptr;
  output_ = &set_.forward(camera, sh_degree_, settings);
}

}  // namespace glint
