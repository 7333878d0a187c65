// SPDX-License-Identifier: MIT
// A set of surfels as it is rendered: its parameters, and the buffers of passes over them. What
// trains one is glint/train/trainable_set.h.
#pragma once

#include "glint/render/shade.h"
#include "glint/render/trace.h"

namespace glint {

// Buffers of a rasterisation of a set.
struct RasterPass {
  int sh_degree = 3;
  ActivatedSurfels activated;
  const ActivatedSurfels* of_first = nullptr;  // of forward_again(); null: its own
  Rasterizer rasterizer;

  const ActivatedSurfels& used() const { return of_first != nullptr ? *of_first : activated; }
};
// Buffers of rays through a set.
struct TracePass {
  ActivatedSurfels activated;
  Tracer tracer;
};

class SurfelSet {
 public:
  SurfelSet() = default;
  explicit SurfelSet(SurfelCloud cloud) : cloud_(std::move(cloud)) {}

  // Rasterises the set; the output stays valid until the next call. near_limit: see RasterInput; it
  // and the set must stay as they are until backward().
  const RasterOutput& forward(
      const Camera& camera,
      int sh_degree,
      const RasterSettings& settings = {},
      BorrowedImage near_limit = {}
  ) {
    return forward(pass_, camera, sh_degree, settings, near_limit);
  }
  // The same with buffers of its own: a further rasterisation within a step.
  const RasterOutput& forward(
      RasterPass& pass,
      const Camera& camera,
      int sh_degree,
      const RasterSettings& settings = {},
      BorrowedImage near_limit = {}
  ) const;
  // What `first` has just rasterised of this set, which nobody wrote since, once more: seen by the
  // same camera, with the same colours, which are not computed again, nor are the lists of surfels.
  // `first` must rasterise nothing else before this pass's backward().
  // needed, near_limit: see RasterInput.
  const RasterOutput& forward_again(
      RasterPass& pass,
      RasterPass& first,
      const RasterSettings& settings = {},
      BorrowedImage needed = {},
      BorrowedImage near_limit = {}
  ) const;
  // The same for rays, which must stay as they are until trace_backward().
  const TraceOutput& trace(const Rays& rays, int sh_degree, const TraceSettings& settings = {}) {
    return trace(trace_pass_, rays, sh_degree, settings);
  }
  // With buffers of its own.
  const TraceOutput& trace(
      TracePass& pass, const Rays& rays, int sh_degree, const TraceSettings& settings = {}
  ) const;

  // Depth of the first surface of what the first of them rasterised last, see Rasterizer.
  void first_surface(const Image& mask, const FirstSurfaceSettings& settings, Image& depth) {
    pass_.rasterizer.first_surface(mask, settings, depth);
  }

  // Buffers of the first of them, whose options of activation may be set before it.
  RasterPass& pass() { return pass_; }
  SurfelCloud& cloud() { return cloud_; }
  const SurfelCloud& cloud() const { return cloud_; }
  std::size_t num_pairs() const { return pass_.rasterizer.num_pairs(); }

 protected:
  SurfelCloud cloud_;
  RasterPass pass_;
  TracePass trace_pass_;
};

// dL/d(raw parameters) of the pass's last rasterisation of `cloud`, added to `dL_dcloud`; returns
// those of what was rasterised.
const RasterGradient& raster_backward(
    const SurfelCloud& cloud,
    RasterPass& pass,
    const RasterOutputGradient& dL_doutput,
    SurfelCloud& dL_dcloud
);
// The same for rays.
const TraceGradient& trace_backward(
    TracePass& pass, const TraceOutputGradient& dL_doutput, SurfelCloud& dL_dcloud
);

// Whether all values are; looked at where ops run.
bool is_finite(const FloatArray& values);
// Errors (kBadPrediction): a parameter is not finite; names set, array and surfel.
void check_finite(const SurfelCloud& cloud, const std::string& set_name);

}  // namespace glint
