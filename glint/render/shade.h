// SPDX-License-Identifier: MIT
// Activation of a whole cloud for one camera: scales, opacities, SH colours and extra channels, as
// rasterize() wants them, and the way back to the raw parameters.
#pragma once

#include <vector>

#include "glint/render/rasterize.h"
#include "glint/scene/surfels.h"

namespace glint {

// What of a cloud a pass rasterises.
struct ActivationOptions {
  static constexpr int kNone = -1;
  int opacity_factor = kNone;  // index of an extra channel that opacities are multiplied by
  bool color_only = false;     // without extra channels among the features
  // [N][3], added to the colours behind their clamp (LobeAppearance, say); null: nothing. They must
  // stay as they are until activate_vjp(); their gradient: color_gradient().
  const FloatArray* color_offsets = nullptr;
};

// What scales and opacities were made of, and they themselves (Array::device_revision()); 0: not
// known.
struct ActivationRevision {
  std::uint64_t log_scales = 0, opacity_logits = 0, scales = 0, opacities = 0;
  bool known() const {
    return log_scales != 0 && opacity_logits != 0 && scales != 0 && opacities != 0;
  }
  friend bool operator==(const ActivationRevision&, const ActivationRevision&) = default;
};

struct ActivatedSurfels {
  ActivationOptions options;    // of activate(), not of what is traced
  int channels = 3;             // 3 + number of extra channels, or 3
  FloatArray scales;            // [N][2] metres
  FloatArray opacities;         // [N]
  FloatArray features;          // [N][channels]: colour, then extra channels
  ActivationRevision revision;  // of scales and opacities
};

// eye: camera centre, metres. sh_degree: 0..3 (coefficients above are ignored).
void activate(const SurfelCloud& cloud, Vec3f eye, int sh_degree, ActivatedSurfels& activated);

// Scales and opacities alone, for trace(): its colours depend on the rays. On a GPU, where neither
// they nor what they are made of was written since, they stay.
void activate_geometry(const SurfelCloud& cloud, ActivatedSurfels& activated);

// The activated cloud as rasterize() takes it.
RasterInput raster_input(const SurfelCloud& cloud, const ActivatedSurfels& activated);

// Adds dL/d(raw parameters) to `dL_dcloud` (same size as `cloud`); gradient: of rasterize().
void activate_vjp(
    const SurfelCloud& cloud,
    Vec3f eye,
    int sh_degree,
    const ActivatedSurfels& activated,
    const RasterGradient& gradient,
    SurfelCloud& dL_dcloud
);

// dL/d(colours as they were rasterised) [N][3], and so of what was added to them.
void color_gradient(const RasterGradient& gradient, int channels, FloatArray& dL_dcolors);

}  // namespace glint
