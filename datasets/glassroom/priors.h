// SPDX-License-Identifier: MIT
// Simulated priors: what a monocular inverse renderer would predict for a view, made from ground
// truth by a stated noise model. They are always labelled as simulated (scene.json,
// "simulated_priors").
//
// The model, per view, with S(r) a smooth random field of wavelength r x image width, about
// standard normal, and B a Gaussian blur of sigma = blur x image width (at least 0.5 pixels; none
// where blur is 0):
//   failures    patches of glass where the predictor looks through the pane: the field S(0.12)
//   above
//               the threshold that covers `failure_rate` of an infinite pane. In a patch all four
//               maps describe the surface behind the glass.
//   normal      n' = normalize(B(n)), then turned by S(0.2) * sigma_normal_deg / sqrt(2) about each
//               image axis: a root mean square angle of sigma_normal_deg where n faces the camera,
//               of sigma_normal_deg * sqrt((1 + n_z^2) / 2) elsewhere.
//   depth       z' = a z (1 + c (z / z_max - 1/2)) + b + sigma_depth z S(0.25) on B(z), with
//               a = exp(N(0, sigma_scale)), b = N(0, sigma_shift) metres, c = U(-bend, bend); then
//               mapped affinely to [0.05, 0.95] per view, so only its order and shape remain.
//               Larger is farther; 0 where there is no surface.
//   albedo      B(albedo) * (1 + sigma_color S(0.15)) + sigma_pixel N per pixel; glass is nearly
//               black, a value below 0.04 before the noise.
//   basecolor   the same on the base colour; glass is bright, 0.8 to 0.95 before the noise.
//   leaks       of the albedo alone, in patches S(0.12): opaque surface is as black as glass
//               (`dark_leak` of it), glass is as bright as an opaque pane, 0.3 to 0.8
//               (`bright_leak` of the glass that does not fail).
//   missing     views of which nothing was predicted (`missing_rate` of them).
// At a mirror all four describe its surface, and never fail: its plane, an albedo as black as a
// metal's (as glass, it is 0 before the noise), the base colour that it mirrors with. Networks
// often see the mirrored room instead.
// Colours are stored as sRGB-encoded values. Leaks and missing views draw random numbers of their
// own, so that models without them give the same bytes as before there were any.
//
// Levels, by the factor of all noise (blur, sigmas, bend) and the rates:
//             noise  failure  missing  dark_leak  bright_leak
//   perfect     0      0        0        0          0          the truth but for glass and affine
//   good        0.5    0.05     0        0          0
//   default     1      0.1      0        0          0
//   poor        2      0.2      0.1      0.02       0.1
//   bad         4      0.4      0.3      0.1        0.3
// And default with one column of poor: noise, see-through (failure), gaps (missing), dark-leak,
// bright-leak; or with several of them, joined: noise+see-through.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/glassroom/path_tracer.h"
#include "datasets/glassroom/prior_levels.h"
#include "glint/core/config.h"
#include "glint/scene/scene.h"

namespace glint {

struct PriorModel {
  float blur = 0.004f;
  float failure_rate = 0.1f;
  float sigma_normal_deg = 5;
  float sigma_scale = 0.25f, sigma_shift = 0.3f, bend = 0.12f, sigma_depth = 0.012f;
  float sigma_color = 0.06f, sigma_pixel = 0.012f;
  float missing_rate = 0, dark_leak = 0, bright_leak = 0;

  template <class V>
  void visit(V&& v) {
    v("blur", blur, "sigma of the blur, share of the image width");
    v("failure_rate", failure_rate, "share of glass where the surface behind is predicted");
    v("sigma_normal_deg", sigma_normal_deg, "root mean square angle of the normal's smooth error");
    v("sigma_scale", sigma_scale, "of the logarithm of a view's depth scale");
    v("sigma_shift", sigma_shift, "of a view's depth shift, metres");
    v("bend", bend, "largest relative non-linearity of depth");
    v("sigma_depth", sigma_depth, "relative smooth error of depth");
    v("sigma_color", sigma_color, "relative smooth error of albedo and base colour");
    v("sigma_pixel", sigma_pixel, "noise per pixel of albedo and base colour");
    v("missing_rate", missing_rate, "share of views of which nothing was predicted");
    v("dark_leak", dark_leak, "share of opaque surface whose albedo is as black as glass");
    v("bright_leak", bright_leak, "share of glass whose albedo is that of an opaque pane");
  }
};

// Of one of prior_kinds(), or of flaws joined by '+'. Errors: check_prior_level()'s.
PriorModel prior_level(const std::string& name);

// Which of `count` views the predictor left out, ascending: missing_rate of them, rounded, one in
// each of as many stretches of equal length, and never all. Deterministic in (seed, stream).
std::vector<int> views_without_priors(
    const PriorModel& model, int count, std::uint64_t seed, std::uint64_t stream
);

// Of a view that is not missing. `behind_albedo` [H][W][3]: linear albedo of the first opaque
// surface. Deterministic in (seed, view). Sizes as in `truth`; normals are zero and depth is 0
// where no surface was hit.
MapSet simulate_priors(
    const PathTracerOutput& truth,
    ImageView behind_albedo,
    const PriorModel& model,
    std::uint64_t seed,
    std::uint64_t view
);

}  // namespace glint
