// SPDX-License-Identifier: MIT
// The pixels between the three sets of GLINT: from the interface's G-buffer to mirrored rays and
// transparency, from the sets' radiance to the picture [Na26 Eq. 5-10], and the way back.
#pragma once

#include "glint/render/glass_kernels.h"
#include "glint/render/rasterize.h"
#include "glint/render/trace.h"

namespace glint {

// What the interface says about each pixel.
struct GlassBuffer {
  Image depth;         // [H][W][1] expected depth, metres; 0: nothing hit
  Image normal;        // [H][W][3] unit, camera space; zero: nothing hit
  Image transparency;  // [H][W][1] t, composited (not divided by alpha)
  Image specular;      // [H][W][1] s, composited
  Image fresnel;       // [H][W][1]
  Image specularity;   // [H][W][1] k_s; 0 where nothing was hit
  Rays reflected;      // world; unit directions, 0 where nothing was hit
};

// Radiance of the sets and the picture made of it, [H][W][3].
struct GlassLayers {
  Image interface, transmission, reflection;
};

// Names of an interface set's extra channels.
inline constexpr const char* kTransparency = "transparency";
inline constexpr const char* kSpecular = "specular";
// Where the rasterised features of a set have them.
InterfaceChannels interface_channels(const SurfelCloud& interface);

// Camera rays with camera-space z = 1: t is planar depth.
void camera_rays(const Camera& camera, Rays& rays);
PixelRays pixel_rays(const Camera& camera);

// The part of the picture [H][W][3] that is `layer` times its weight [H][W][1], on the host.
Image part_of_picture(
    const Image& picture, const Image& layer, const Image& weight, bool linear_light
);

class GlassTransport {
 public:
  explicit GlassTransport(GlassOptions options = {}) : options_(options) {}
  void set_options(GlassOptions options) { options_ = options; }

  // From the interface set as it was rasterised, with the options' channels.
  const GlassBuffer& read_interface(const Camera& camera, const RasterOutput& interface);
  // The picture [H][W][3]. Images of layers that are switched off may be empty.
  const Image& compose(const GlassLayers& layers);

  // Back through compose(): fills the gradients of the layers, and keeps those of t and k_s.
  const GlassLayers& compose_vjp(const GlassLayers& layers, const Image& dL_dimage);
  // Back through read_interface(), with the mirrored rays' gradient (may be null), dL/dt from
  // losses on the transparency map (may be empty) and the layers' own. Adds to the interface's
  // gradient, whose images must have their sizes.
  void interface_vjp(
      const Camera& camera,
      const RasterOutput& interface,
      const Rays* dL_drays,
      const Image& dL_dtransparency,
      RasterOutputGradient& dL_dinterface
  ) const;

  const GlassBuffer& buffer() const { return buffer_; }

 private:
  GlassInputs inputs(const GlassLayers& layers) const;

  GlassOptions options_;
  GlassBuffer buffer_;
  Image image_, dL_dtransparency_, dL_dmirrored_;
  GlassLayers dL_dlayers_;
};

}  // namespace glint
