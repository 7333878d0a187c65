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

#include "glint/render/first_surface.h"
#include "glint/render/raster_maps.h"
#include "glint/scene/camera.h"

namespace glint {

struct DepthModeSettings;  // depth_modes.h

struct RasterSettings {
  float near_plane = 0.2f;       // metres, planar depth
  bool with_distortion = false;  // also the distortion map [Huang24 Eq. 13]
  float distortion_near = 0.2f;  // metres, of the NDC mapping of the distortion loss
  float distortion_far = 100.0f;
  bool with_plane_distance = false;  // also the plane_distance map
  // false: nobody looks at depth_sum, depth_median and normal. They are left out of passes of three
  // features and without the maps and sums asked for here, and stay empty.
  bool with_surface = true;
  // Also owned_pixels and radii of the output and screen_abs of the gradient.
  bool with_statistics = false;
  // RasterGradient::screen, the statistic of density control, counts hits of the low-pass, too.
  bool screen_with_low_pass = false;
  // Feature channels, a bit each, whose gradient goes to the features alone (MapChannels).
  std::uint32_t detached_features = 0;
  // On the CPU: at most so many pixels at once, of the widths that there are (16 with AVX-512, 8,
  // 1: without SIMD); the same text, and the same bytes with 8 and 16. For perf and tests.
  int lanes = 16;
};

// Activated surfels, structure of arrays; borrowed. N surfels, C feature channels (1..16).
struct RasterInput {
  std::size_t count = 0;
  int channels = 3;
  Borrowed<float> means;      // [N][3] world, metres
  Borrowed<float> scales;     // [N][2] > 0, metres
  Borrowed<float> rotations;  // [N][4] w x y z, need not be normalised
  Borrowed<float> opacities;  // [N] in [0, 1]
  Borrowed<float> features;   // [N][C]: colour after SH first, then extra channels
  BorrowedImage near_limit;   // optional [H][W][1]: only hits with z > limit count
  // Optional [H][W][1]: nobody looks at pixels where it is 0. Whole tiles of them may count as if
  // they had no surfels (on a GPU, all pixels are made).
  BorrowedImage needed;
};

// One rasterisation. Borrowed arrays must stay where and what they are until its backward().
struct RasterCall {
  RasterInput input;
  Camera camera;
  RasterSettings settings;

  MapChannels maps() const {
    MapChannels has{
        input.channels,
        settings.with_distortion,
        settings.with_plane_distance,
        settings.with_statistics};
    has.surface = settings.with_surface || has.distortion || has.has_extras() ||
                  has.features != kColorChannels;
    has.detached = settings.detached_features;
    return has;
  }
};

struct RasterOutput : RasterMaps<ImageMap> {
  FloatArray visibility;        // [N] sum over pixels of w
  Array<std::uint8_t> in_view;  // [N] 1: reached at least one tile
  // Both empty without with_statistics.
  FloatArray owned_pixels;  // [N] number of pixels it counts at with T > 0.5 in front of it
  FloatArray radii;         // [N] pixels, see screen_radius() in project.h; 0: not in view
};

using RasterOutputGradient = RasterMaps<ImageMap>;  // dL/d(output); empty images count as zero

struct RasterGradient {
  FloatArray means, scales, rotations, opacities, features;  // shapes of RasterInput
  FloatArray screen;  // [N][2] dL/d(projected centre) x (W/2, H/2): NDC, for densification
  // [N][2] sum over pixels of |dL/d(the surfel's footprint shifted on the screen)| x (W/2, H/2),
  // see screen_slope() in splat_hit.h; empty without with_statistics.
  FloatArray screen_abs;

  // f(name, array of each, floats a surfel; 0: the call has it not).
  template <class F, class... Others>
  static void for_each_array(MapChannels has, F&& f, Others&... gradients) {
    const auto channels = static_cast<std::size_t>(has.features);
    f("means", std::size_t{3}, gradients.means...);
    f("scales", std::size_t{2}, gradients.scales...);
    f("rotations", std::size_t{4}, gradients.rotations...);
    f("opacities", std::size_t{1}, gradients.opacities...);
    f("features", channels, gradients.features...);
    f("screen", std::size_t{2}, gradients.screen...);
    f("screen_abs", std::size_t{has.statistics ? 2u : 0u}, gradients.screen_abs...);
  }
};

class Rasterizer {
 public:
  Rasterizer();
  ~Rasterizer();
  Rasterizer(Rasterizer&&) noexcept;
  Rasterizer& operator=(Rasterizer&&) noexcept;

  // What both return stays valid until the next call of the same. Both are deterministic: the same
  // bytes for any number of threads. Errors (kUsage): array sizes that do not match; backward()
  // without a forward().
  //
  // first: one that has just rasterised the same arrays, which nobody wrote since, with the same
  // camera: its splats and lists are used, and the bytes are the same. Features, near limit and
  // maps may differ. It must rasterise nothing else before this one's backward(). Where its arrays
  // or its camera are others, it is not used.
  const RasterOutput& forward(const RasterCall& call, Rasterizer* first = nullptr);
  // Gradients of the last forward call.
  const RasterGradient& backward(const RasterOutputGradient& dL_doutput);

  // Of the last forward call: depth [H][W][1] of the first surface (first_surface.h), metres, 0:
  // none. mask [H][W][1]: pixels above 0.5 see something behind it. Errors (kUsage): the mask has
  // not the image's size; there was no forward().
  void first_surface(const Image& mask, const FirstSurfaceSettings& settings, Image& depth);
  // Of the last forward call: depths [H][W][1] of the first and of the last mode of the weights
  // along each ray (depth_modes.h), metres, 0: none. Errors (kUsage): there was no forward().
  void depth_modes(const DepthModeSettings& settings, Image& first, Image& last);

  const RasterCall& call() const;      // the last one; errors (kUsage): there was none
  const RasterOutput& output() const;  // of it
  // Of the last forward call: (surfel, tile) pairs, and pixels inside the surfels' screen boxes.
  std::size_t num_pairs() const;
  std::size_t num_pixel_pairs() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace glint
