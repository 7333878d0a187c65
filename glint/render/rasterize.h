// SPDX-License-Identifier: MIT
// Rasterisation of surfels by tiles, forward and backward [Huang24]. Input is a cloud after
// activation and SH evaluation; the contract is the same on every backend.
//
// A surfel contributes to a pixel iff (all per pixel, at the pixel centre)
//   rho <= 9 (3 sigma), alpha = min(0.99, opacity exp(-rho/2)) >= 1/255, z > near and z >
//   near_limit,
// where rho = min(rho3, rho2): rho3 = u^2 + v^2 at the ray's intersection, rho2 = 2 |p - c|^2 the
// screen-space low-pass around the centre c of the surfel's exact 3-sigma box; and the pixel's
// transmittance after it stays >= 1e-4. Order: depth of the surfel's centre, ties by index.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "glint/core/image.h"
#include "glint/scene/camera.h"

namespace glint {

struct RasterSettings {
  float near_plane = 0.2f;       // metres, planar depth
  bool with_distortion = false;  // also the distortion map [Huang24 Eq. 13]
  float distortion_near = 0.2f;  // metres, of the NDC mapping of the distortion loss
  float distortion_far = 100.0f;
};

// Activated surfels, structure of arrays; borrowed. N surfels, C feature channels (1..16).
struct RasterInput {
  std::size_t count = 0;
  int channels = 3;
  std::span<const float> means;      // [N][3] world, metres
  std::span<const float> scales;     // [N][2] > 0, metres
  std::span<const float> rotations;  // [N][4] w x y z, need not be normalised
  std::span<const float> opacities;  // [N] in [0, 1]
  std::span<const float> features;   // [N][C]: colour after SH first, then extra channels
  ImageView near_limit;              // optional [H][W][1]: only hits with z > limit count
};

struct RasterOutput {
  Image features;      // [H][W][C] sum w f; no background is added
  Image alpha;         // [H][W][1] sum w = 1 - transmittance
  Image depth_sum;     // [H][W][1] sum w z; expected depth = depth_sum / alpha
  Image depth_median;  // [H][W][1] z of the last contributor met while transmittance > 0.5; 0: none
  Image normal;        // [H][W][3] sum w n in camera space, each n facing the camera; not unit
  Image distortion;    // [H][W][1] sum_ij w_i w_j (m_i - m_j)^2, j < i; empty unless asked for
  FloatArray visibility;        // [N] sum over pixels of w
  Array<std::uint8_t> in_view;  // [N] 1: reached at least one tile
};

struct RasterOutputGradient {  // dL/d(output); empty images count as zero
  Image features, alpha, depth_sum, depth_median, normal, distortion;
};

struct RasterGradient {
  FloatArray means, scales, rotations, opacities, features;  // shapes of RasterInput
  FloatArray screen;  // [N][2] dL/d(projected centre) x (W/2, H/2): NDC, for densification
};

class Rasterizer {
 public:
  Rasterizer();
  ~Rasterizer();
  Rasterizer(Rasterizer&&) noexcept;
  Rasterizer& operator=(Rasterizer&&) noexcept;

  // Both are deterministic: the same bytes for any number of threads. `scalar` runs the scalar
  // instantiation of the same text (for perf and tests).
  void forward(
      const RasterInput& input,
      const Camera& camera,
      const RasterSettings& settings,
      RasterOutput& output,
      bool scalar = false
  );
  // Gradients of the last forward call; input, camera and settings must be the same.
  void backward(
      const RasterInput& input,
      const Camera& camera,
      const RasterSettings& settings,
      const RasterOutput& output,
      const RasterOutputGradient& dL_doutput,
      RasterGradient& gradient,
      bool scalar = false
  );
  // Of the last forward call: (surfel, tile) pairs, and pixels inside the surfels' screen boxes.
  std::size_t num_pairs() const;
  std::size_t num_pixel_pairs() const;

 private:
  struct Backends;  // what backward needs from forward; reused between calls
  std::unique_ptr<Backends> backends_;
};

}  // namespace glint
