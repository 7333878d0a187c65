// SPDX-License-Identifier: MIT
// Path tracer on Embree: next-event estimation with multiple importance sampling, Russian roulette
// (up to 200 bounces), thin dielectrics as specular slabs, mirrors; shadow rays go straight through
// thin glass with its transmittance. Deterministic: the random numbers of a pixel depend on (seed,
// view, pixel, sample) only.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "datasets/glassroom/trace_scene.h"
#include "glint/scene/camera.h"
#include "glint/scene/maps.h"
#include "glint/scene/ply.h"

namespace glint {

struct PathTracerSettings {
  int spp = 64;           // samples a pixel, stratified in the pixel
  int max_bounces = 200;  // scatterings of a path; going straight through glass is none
  std::uint64_t seed = 0;
  std::uint64_t view = 0;             // stream of this view
  bool next_event_estimation = true;  // off: BSDF sampling alone (noisy; for checks)
  bool layers = false;                // also the maps of each layer and path
};

// Geometry maps are of the ray through the pixel centre (no anti-aliasing).
struct PathTracerOutput {
  Image radiance;  // [H][W][3] linear
  // depth, normal (shading normal), glass, behind_depth, behind_normal; albedo (diffuse, linear, of
  // the first surface; glass, conductors and mirrors: 0); basecolor (glass: its tint); where the
  // first surface is glass (0 elsewhere) transmitted and reflected: the part of radiance that
  // passed it, and the part that it mirrored, which add up exactly. Only the first pane splits.
  // Samples of a border pixel that miss the pane count as transmitted.
  //
  // With layers: layer_1_mirror, layer_<2..4>_{depth, normal, glass, mirror} (layers.h; 0: no such
  // surface, and a fifth one is in no map); where the first surface is glass or a mirror (0
  // elsewhere) path_t ... path_rest, radiance by what its path did at the first two panes or
  // mirrors (PathKind). They add up to the radiance; at glass T + TT + TR is transmitted.
  MapSet maps;
  // With layers and two samples or more: "rgb" (linear) and the parts from the first and from the
  // second half of the samples, for the noise of their mean.
  std::array<MapSet, 2> halves;
};

class PathTracer {
 public:
  explicit PathTracer(const TraceScene& scene);  // builds the BVH; keeps a reference to `scene`
  explicit PathTracer(TraceScene&&) = delete;    // a temporary would dangle
  ~PathTracer();
  PathTracerOutput render(const Camera& camera, const PathTracerSettings& settings) const;

  // First hit along a ray, glass included or passed through; for visibility and camera placement.
  struct FirstHit {
    bool hit = false;
    float t = 0;                 // in units of |direction|
    Vec3f position{}, normal{};  // geometric normal facing the origin
    Vec3f albedo{};              // linear, textured; 0 for glass
    int mesh = -1;
    bool glass = false, mirror = false;
  };
  FirstHit first_hit(Vec3f origin, Vec3f direction, bool skip_glass) const;
  bool occluded(Vec3f from, Vec3f to) const;  // by opaque surfaces only

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Reflectance of a thin slab of index `ior` at angle cosine `cos_i`, all orders summed, unpolarised
// light: per polarisation R = 2r / (1 + r) without absorption.
float thin_slab_reflectance(float cos_i, float ior);

}  // namespace glint
