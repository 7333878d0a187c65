// SPDX-License-Identifier: MIT
#include "glint/render/glass_transport.h"

#include "glint/core/kernel.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 1024;  // pixels a block

const float* data_or_null(const Image& image) { return image.empty() ? nullptr : image.data(); }

}  // namespace

PixelRays pixel_rays(const Camera& camera) {
  return {
      camera.fx,
      camera.fy,
      camera.cx,
      camera.cy,
      static_cast<std::size_t>(camera.width),
      cast<float>(camera.rotation_cam_from_world),
      cast<float>(camera.center())};
}

void camera_rays(const Camera& camera, Rays& rays) {
  fit(rays.origins, camera.size(), 3);
  fit(rays.directions, camera.size(), 3);
  run_kernel(
      camera.size().num_pixels(),
      kGrain,
      CameraRays{pixel_rays(camera), rays.origins.data(), rays.directions.data()}
  );
}

InterfaceChannels interface_channels(const SurfelCloud& interface) {
  constexpr int kBehindColor = 3;
  InterfaceChannels channels;
  for (std::size_t i = 0; i < interface.num_extra(); ++i) {
    const int channel = kBehindColor + static_cast<int>(i);
    if (interface.extra_names[i] == kTransparency) channels.transparency = channel;
    if (interface.extra_names[i] == kSpecular) channels.specular = channel;
  }
  return channels;
}

const GlassBuffer&
GlassTransport::read_interface(const Camera& camera, const RasterOutput& interface) {
  const ImageSize size = camera.size();
  GlassBuffer& b = buffer_;
  for (Image* image : {&b.depth, &b.transparency, &b.specular, &b.fresnel, &b.specularity})
    fit(*image, size, 1);
  for (Image* image : {&b.normal, &b.reflected.origins, &b.reflected.directions})
    fit(*image, size, 3);
  const GlassMaps out{
      b.depth.data(),
      b.normal.data(),
      b.transparency.data(),
      b.specular.data(),
      b.fresnel.data(),
      b.specularity.data(),
      b.reflected.origins.data(),
      b.reflected.directions.data()};
  run_kernel(
      size.num_pixels(),
      kGrain,
      ReadInterface{
          pixel_rays(camera),
          options_,
          interface.features.channels(),
          interface.features.data(),
          interface.alpha.data(),
          interface.depth_sum.data(),
          interface.normal.data(),
          out}
  );
  return buffer_;
}

GlassInputs GlassTransport::inputs(const GlassLayers& layers) const {
  return {
      data_or_null(layers.interface),
      data_or_null(layers.transmission),
      data_or_null(layers.reflection),
      buffer_.transparency.data(),
      buffer_.specularity.data()};
}

const Image& GlassTransport::compose(const GlassLayers& layers) {
  fit(image_, buffer_.depth.size(), 3);
  run_kernel(image_.num_pixels(), kGrain, ComposeGlass{inputs(layers), image_.data()});
  return image_;
}

const GlassLayers& GlassTransport::compose_vjp(const GlassLayers& layers, const Image& dL_dimage) {
  const ImageSize size = buffer_.depth.size();
  for (Image* image : {&dL_dlayers_.interface, &dL_dlayers_.transmission, &dL_dlayers_.reflection})
    fit(*image, size, 3);
  fit(dL_dtransparency_, size, 1);
  fit(dL_dmirrored_, size, 1);
  run_kernel(
      size.num_pixels(),
      kGrain,
      ComposeGlassVjp{
          inputs(layers),
          options_,
          dL_dimage.data(),
          dL_dlayers_.interface.data(),
          dL_dlayers_.transmission.data(),
          dL_dlayers_.reflection.data(),
          dL_dtransparency_.data(),
          dL_dmirrored_.data()}
  );
  return dL_dlayers_;
}

void GlassTransport::interface_vjp(
    const Camera& camera,
    const RasterOutput& interface,
    const Rays* dL_drays,
    const Image& dL_dtransparency,
    RasterOutputGradient& dL_dinterface
) const {
  run_kernel(
      buffer_.depth.num_pixels(),
      kGrain,
      ReadInterfaceVjp{
          pixel_rays(camera),
          options_,
          dL_dinterface.features.channels(),
          interface.alpha.data(),
          interface.depth_sum.data(),
          interface.normal.data(),
          buffer_.normal.data(),
          buffer_.specular.data(),
          buffer_.fresnel.data(),
          dL_dlayers_.interface.data(),
          dL_dtransparency_.data(),
          dL_dmirrored_.data(),
          data_or_null(dL_dtransparency),
          dL_drays == nullptr ? nullptr : dL_drays->origins.data(),
          dL_drays == nullptr ? nullptr : dL_drays->directions.data(),
          dL_dinterface.features.data(),
          dL_dinterface.depth_sum.data(),
          dL_dinterface.alpha.data(),
          dL_dinterface.normal.data()}
  );
}

}  // namespace glint
