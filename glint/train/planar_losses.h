// SPDX-License-Identifier: MIT
// All losses of planar surfels [Chen24] on one rasterised set: a view on its own
// (plane_consistency.h), and with one of its neighbours, drawn at random and rendered for it
// (multi_view_losses.h).
#pragma once

#include <string>
#include <vector>

#include "glint/method.h"
#include "glint/train/multi_view_losses.h"
#include "glint/train/neighbor_views.h"
#include "glint/train/plane_consistency.h"
#include "glint/train/trainable_set.h"

namespace glint {

struct PlanarLossConfig {
  float lambda_plane = 0.015f, lambda_geometric = 0.03f, lambda_photometric = 0.15f;
  int from = 7000;
  NeighborConfig neighbors;
  float min_z = 0.1f;  // published scene units
  float max_error = 1, max_dissimilarity = 0.9f;
  int max_patches = 102400;

  template <class V>
  void visit(V&& v) {
    v("lambda_plane", lambda_plane, "weight of the consistency of normals and plane depth");
    v("lambda_geometric", lambda_geometric, "weight of the reprojection error, per pixel");
    v("lambda_photometric", lambda_photometric, "weight of 1 - NCC^2 of patches");
    v("planes_from", from, "first published iteration of these losses");
    neighbors.visit(v);
    v("reprojection_min_z", min_z, "points nearer do not count, published scene units");
    v("reprojection_max_error", max_error, "pixels; beyond, a pixel counts as occluded");
    v("max_dissimilarity", max_dissimilarity, "1 - NCC^2 of patches that no longer count");
    v("max_patches", max_patches, "patches a step");
  }
};

class PlanarLosses {
 public:
  // `config` with windows of this run; `seed` of the neighbours that are drawn. Returns a warning
  // where views have no neighbour: these train without the losses of two views.
  std::vector<std::string> set_up(
      const PlanarLossConfig& config,
      const Scene& scene,
      std::uint64_t seed,
      const std::string& method
  );
  // `set` has rendered training view `view` into `output`, with plane distances. Adds the gradients
  // of normal and plane_distance, whose images have their shapes, to dL_doutput; those of the
  // neighbour go into the set at once.
  void add(
      std::size_t view,
      int iteration,
      TrainableSet& set,
      const RasterOutput& output,
      RasterOutputGradient& dL_doutput,
      StepStats& stats
  );

 private:
  struct Photo {
    Image gray, flatness;
    std::vector<std::size_t> neighbors;
  };
  void add_neighbor(
      std::size_t view,
      std::size_t neighbor,
      int iteration,
      TrainableSet& set,
      const RasterOutput& output,
      RasterOutputGradient& dL_doutput,
      StepStats& stats
  );

  PlanarLossConfig config_;
  const Scene* scene_ = nullptr;
  std::uint64_t seed_ = 0;
  std::vector<Photo> photos_;  // of the training views
  PlaneConsistencyLoss consistency_;
  MultiViewLosses multi_view_;
  RasterPass neighbor_pass_;
  Image depth_, dL_ddepth_, neighbor_depth_, dL_dneighbor_depth_;
  RasterOutputGradient dL_dneighbor_;
};

}  // namespace glint
