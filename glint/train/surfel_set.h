// SPDX-License-Identifier: MIT
// One trainable set of surfels, rasterised or traced: the building block that methods are composed
// of. Holds the parameters, the optimiser, densification, and the buffers of the two passes.
#pragma once

#include "glint/render/shade.h"
#include "glint/render/trace.h"
#include "glint/scene/scene.h"
#include "glint/train/adam.h"
#include "glint/train/densify.h"

namespace glint {

class SurfelSet {
 public:
  SurfelSet() = default;
  SurfelSet(
      SurfelCloud cloud, SurfelRates rates, DensifyConfig densify, float extent, std::uint64_t seed
  );

  // Renders the set; the output stays valid until the next call. near_limit: see RasterInput.
  const RasterOutput& forward(
      const Camera& camera, int sh_degree, const RasterSettings& settings, ImageView near_limit = {}
  );
  // Back through the last forward call; adds to the gradient of the parameters.
  void backward(
      const Camera& camera,
      int sh_degree,
      const RasterSettings& settings,
      const RasterOutputGradient& dL_doutput,
      ImageView near_limit = {}
  );
  // The same for rays; trace_backward returns the rays' gradient, valid until the next call.
  const TraceOutput& trace(const Rays& rays, int sh_degree, const TraceSettings& settings);
  const Rays& trace_backward(
      const Rays& rays,
      int sh_degree,
      const TraceSettings& settings,
      const TraceOutputGradient& dL_doutput
  );
  // Optimiser step and, when due, densification. `step` counts from 1.
  DensifyCounts update(int step);

  SurfelCloud& cloud() { return cloud_; }
  const SurfelCloud& cloud() const { return cloud_; }
  const SurfelCloud& gradient() const { return gradient_; }
  const ActivatedSurfels& activated() const { return activated_; }  // of the last pass
  std::size_t num_pairs() const { return rasterizer_.num_pairs(); }

 private:
  SurfelCloud cloud_, gradient_;
  SurfelRates rates_;
  float extent_ = 1;
  SurfelAdam adam_;
  Densifier densifier_{{}, 1, 0};
  ActivatedSurfels activated_;
  Rasterizer rasterizer_;
  RasterOutput output_;
  RasterGradient raster_gradient_;
  Tracer tracer_;
  TraceOutput trace_output_;
  TraceGradient trace_gradient_;
};

// The scene's points, or `count` uniform random ones in its bounds where it has none.
PointCloud initial_points(const Scene& scene, std::size_t count, std::uint64_t seed);

// Errors (kBadPrediction): a parameter is not finite; names set, array and surfel.
void check_finite(const SurfelCloud& cloud, const std::string& set_name);

// Expected depth of a rasterised set, [H][W][1]; 0: nothing hit.
void expected_depth_map(const RasterOutput& output, Image& depth);
// Camera-space unit normals; zero: nothing hit.
Image unit_normals(const Image& normal);

}  // namespace glint
