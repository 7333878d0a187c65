// SPDX-License-Identifier: MIT
// Rays of any origin and direction through surfels, forward and backward: the counterpart of
// rasterize() for reflections [Na26 Eq. 8]. A hit is where the ray meets a surfel's plane; there is
// no screen-space low-pass. Same formulas (intersect.h, blend.h), same cut-offs.
//
// A surfel contributes to a ray iff t > near, rho = u^2 + v^2 <= max_rho, alpha >= min_alpha, and
// the ray's transmittance after it stays >= min_transmittance. Order: (t, index), so that
// coincident surfels (clones) count once each. Colour: spherical harmonics in the direction of the
// ray.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "glint/core/image.h"
#include "glint/core/vec.h"
#include "glint/render/blend.h"
#include "glint/render/shade.h"

namespace glint {

struct TraceSettings {
  float near = 0;  // ray parameter; below 0 counts as 0
  float max_rho = kMaxRho;
  float min_alpha = kMinAlpha;
  float min_transmittance = kMinTransmittance;
  int max_hits = 256;  // contributors of a ray
};

// Activated surfels, structure of arrays; borrowed. N surfels.
struct TraceInput {
  std::size_t count = 0;
  int sh_degree = 3;
  Borrowed<float> means;      // [N][3] world, metres
  Borrowed<float> scales;     // [N][2] > 0, metres
  Borrowed<float> rotations;  // [N][4] w x y z, need not be normalised
  Borrowed<float> opacities;  // [N] in [0, 1]
  Borrowed<float> sh_dc;      // [N][3]
  Borrowed<float> sh_rest;    // [N][15][3]
};
// scales and opacities of `activated`; its features are not used.
TraceInput trace_input(const SurfelCloud& cloud, const ActivatedSurfels& activated, int sh_degree);

// One ray a pixel: o + t d. d need not be unit (t and depths are in its units). No ray: d = 0, or
// |d|^2 or |o|^2 not finite.
struct Rays {
  Image origins;     // [H][W][3] world, metres
  Image directions;  // [H][W][3]
};

// Borrowed arrays and rays must stay where and what they are until the call's backward().
struct TraceCall {
  TraceInput input;
  const Rays& rays;
  TraceSettings settings;
};

struct TraceOutput {
  Image color;      // [H][W][3] sum w c; no background is added
  Image alpha;      // [H][W][1]
  Image depth_sum;  // [H][W][1] sum w t
  Image normal;     // [H][W][3] sum w n, world space, each n facing the ray's origin
};

struct TraceOutputGradient {  // dL/d(output); empty images count as zero
  Image color, alpha, depth_sum, normal;
};

struct TraceGradient {
  FloatArray means, scales, rotations, opacities, sh_dc, sh_rest;  // shapes of TraceInput
  Rays rays;
  FloatArray visibility;   // [N] sum over rays of w
  FloatArray half_depths;  // [N][3] sum over hits of dL/dmean t / 2, for densification [EnvGS]
};

class Tracer {
 public:
  Tracer();
  ~Tracer();
  Tracer(Tracer&&) noexcept;
  Tracer& operator=(Tracer&&) noexcept;

  // What both return stays valid until the next call of the same. Both are deterministic: the same
  // bytes for any number of threads. Errors (kUsage): sizes that do not match; backward() without a
  // forward().
  const TraceOutput& forward(const TraceCall& call);
  // Gradients of the last forward call.
  const TraceGradient& backward(const TraceOutputGradient& dL_doutput);

  const TraceCall& call() const;      // the last one; errors (kUsage): there was none
  const TraceOutput& output() const;  // of it
  std::size_t num_hits() const;       // contributors of all its rays

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Adds dL/d(raw parameters) to `dL_dcloud`.
void trace_activate_vjp(
    const ActivatedSurfels& activated, const TraceGradient& gradient, SurfelCloud& dL_dcloud
);

}  // namespace glint
