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

// Buffers of one rasterisation of a set.
struct RasterPass {
  ActivatedSurfels activated;
  Rasterizer rasterizer;
  RasterOutput output;
  RasterGradient gradient;
};

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
  // A further rasterisation within a step, with buffers of its own: its gradient is added, its
  // statistics do not count for densification.
  const RasterOutput& forward(
      const Camera& camera,
      int sh_degree,
      const RasterSettings& settings,
      ImageView near_limit,
      RasterPass& pass
  ) const;
  void backward(
      const Camera& camera,
      int sh_degree,
      const RasterSettings& settings,
      const RasterOutputGradient& dL_doutput,
      ImageView near_limit,
      RasterPass& pass
  );
  // The same for rays; trace_backward returns the rays' gradient, valid until the next call.
  const TraceOutput& trace(const Rays& rays, int sh_degree, const TraceSettings& settings);
  const Rays& trace_backward(
      const Rays& rays,
      int sh_degree,
      const TraceSettings& settings,
      const TraceOutputGradient& dL_doutput
  );
  // From now on positions, scales, rotations and opacities stay; the optimiser moves the rest.
  void freeze_geometry();
  // Optimiser step and, when due, densification. `step` counts from 1.
  DensifyCounts update(int step);

  SurfelCloud& cloud() { return cloud_; }
  const SurfelCloud& cloud() const { return cloud_; }
  const SurfelCloud& gradient() const { return gradient_; }
  std::size_t num_pairs() const { return pass_.rasterizer.num_pairs(); }

 private:
  SurfelCloud cloud_, gradient_;
  SurfelRates rates_;
  float extent_ = 1;
  bool frozen_geometry_ = false;
  SurfelAdam adam_;
  Densifier densifier_{{}, 1, 0};
  RasterPass pass_;
  ActivatedSurfels traced_;
  Tracer tracer_;
  TraceOutput trace_output_;
  TraceGradient trace_gradient_;
};

// Errors (kBadPrediction): a parameter is not finite; names set, array and surfel.
void check_finite(const SurfelCloud& cloud, const std::string& set_name);

// Expected depth of a rasterised set, [H][W][1]; 0: nothing hit.
void expected_depth_map(const RasterOutput& output, Image& depth);
// Adds to the gradients of depth_sum and alpha.
void expected_depth_map_vjp(
    const RasterOutput& output, const Image& dL_ddepth, RasterOutputGradient& dL_doutput
);
// Zeros of a shape.
void clear_image(Image& image, ImageSize size, int channels);
// Zeros of the shapes of a rasterised set with so many features.
void clear_gradient(ImageSize size, int features, RasterOutputGradient& dL_doutput);
// Camera-space unit normals; zero: nothing hit.
Image unit_normals(const Image& normal);

}  // namespace glint
