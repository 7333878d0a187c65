// SPDX-License-Identifier: MIT
#include "glint/train/planar_losses.h"

#include <fmt/format.h>

#include <algorithm>

#include "glint/core/rng.h"
#include "glint/render/map_ops.h"

namespace glint {

std::vector<std::string> PlanarLosses::set_up(
    const PlanarLossConfig& config,
    const Scene& scene,
    std::uint64_t seed,
    const std::string& method
) {
  config_ = config;
  scene_ = &scene;
  seed_ = seed;
  const float unit = config.neighbors.unit * scene.spatial_scale;
  multi_view_.settings = {
      config.min_z * unit,
      config.max_error,
      config.max_dissimilarity,
      static_cast<std::size_t>(std::max(0, config.max_patches))};
  auto neighbors = neighbor_views(scene.train, config.neighbors, static_cast<double>(unit));
  photos_.clear();
  std::size_t alone = 0;
  for (std::size_t i = 0; i < scene.train.size(); ++i) {
    const Image& rgb = scene.train[i].rgb;
    alone += neighbors[i].empty() ? 1 : 0;
    photos_.push_back({gray_of(scene.train[i]), flatness_weight(rgb), std::move(neighbors[i])});
  }
  if (alone == 0) return {};
  return {fmt::format(
      "{}: {} has {} of {} training views without a neighbour (within {:.2f} m and {:.0f} degrees);"
      " the losses of two views are off for them",
      method,
      scene.name,
      alone,
      scene.train.size(),
      config.neighbors.max_distance * unit,
      config.neighbors.max_angle_deg
  )};
}

void PlanarLosses::add(
    std::size_t view,
    int iteration,
    TrainableSet& set,
    const RasterOutput& output,
    RasterOutputGradient& dL_doutput,
    StepStats& stats
) {
  if (iteration < config_.from) return;
  const Camera& camera = scene_->train[view].camera;
  const Photo& photo = photos_[view];
  plane_depth_map(camera, output.plane_distance, output.normal, depth_);
  clear_image(dL_ddepth_, depth_.size(), 1);
  const double loss = consistency_.evaluate(
      camera,
      output.normal,
      depth_,
      output.alpha,
      photo.flatness,
      config_.lambda_plane,
      dL_doutput.normal,
      dL_ddepth_
  );
  stats.terms["plane"] = static_cast<double>(config_.lambda_plane) * loss;
  if (!photo.neighbors.empty()) {
    Rng rng(seed_, hash_name("neighbours") + static_cast<std::uint64_t>(iteration));
    const auto drawn = rng.below(static_cast<std::uint32_t>(photo.neighbors.size()));
    add_neighbor(view, photo.neighbors[drawn], iteration, set, output, dL_doutput, stats);
  }
  plane_depth_map_vjp(
      camera,
      output.plane_distance,
      output.normal,
      dL_ddepth_,
      dL_doutput.plane_distance,
      dL_doutput.normal
  );
}

void PlanarLosses::add_neighbor(
    std::size_t view,
    std::size_t neighbor,
    int iteration,
    TrainableSet& set,
    const RasterOutput& output,
    RasterOutputGradient& dL_doutput,
    StepStats& stats
) {
  const Camera& camera = scene_->train[view].camera;
  const Camera& other = scene_->train[neighbor].camera;
  RasterSettings settings;
  settings.with_plane_distance = true;
  constexpr int kNoColor = 0;  // its colours are not looked at: the cheapest SH degree
  const RasterOutput& seen = set.forward(neighbor_pass_, other, kNoColor, settings);
  plane_depth_map(other, seen.plane_distance, seen.normal, neighbor_depth_);
  clear_image(dL_dneighbor_depth_, other.size(), 1);
  const MultiViewTerms terms = multi_view_.evaluate(
      {camera, depth_, photos_[view].gray},
      {other, neighbor_depth_, photos_[neighbor].gray},
      output.normal,
      output.plane_distance,
      {config_.lambda_geometric, config_.lambda_photometric},
      static_cast<std::uint32_t>(hash_name("patches") + static_cast<std::uint64_t>(iteration)),
      dL_ddepth_,
      dL_dneighbor_depth_,
      dL_doutput.normal,
      dL_doutput.plane_distance
  );
  stats.terms["geometric"] = static_cast<double>(config_.lambda_geometric) * terms.geometric;
  stats.terms["patches"] = static_cast<double>(config_.lambda_photometric) * terms.photometric;
  if (terms.num_pixels == 0) return;
  clear_image(dL_dneighbor_.normal, other.size(), 3);
  clear_image(dL_dneighbor_.plane_distance, other.size(), 1);
  plane_depth_map_vjp(
      other,
      seen.plane_distance,
      seen.normal,
      dL_dneighbor_depth_,
      dL_dneighbor_.plane_distance,
      dL_dneighbor_.normal
  );
  set.backward(dL_dneighbor_, neighbor_pass_);
}

}  // namespace glint
