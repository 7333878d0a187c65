// SPDX-License-Identifier: MIT
#include "glint/render/glass_transport.h"

#include "glint/core/kernel.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 1024;  // pixels a block

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
      CameraRays{pixel_rays(camera), rays.origins.on_device(), rays.directions.on_device()}
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
      b.depth.on_device(),
      b.normal.on_device(),
      b.transparency.on_device(),
      b.specular.on_device(),
      b.fresnel.on_device(),
      b.specularity.on_device(),
      b.reflected.origins.on_device(),
      b.reflected.directions.on_device()};
  run_kernel(
      size.num_pixels(),
      kGrain,
      ReadInterface{
          pixel_rays(camera),
          options_,
          interface.features.channels(),
          interface.features.on_device(),
          interface.alpha.on_device(),
          interface.depth_sum.on_device(),
          interface.normal.on_device(),
          out}
  );
  return buffer_;
}

GlassInputs GlassTransport::inputs(const GlassLayers& layers) const {
  return {
      layers.interface.on_device(),
      layers.transmission.on_device(),
      layers.reflection.on_device(),
      buffer_.transparency.on_device(),
      buffer_.specularity.on_device()};
}

const Image& GlassTransport::compose(const GlassLayers& layers) {
  fit(image_, buffer_.depth.size(), 3);
  run_kernel(
      image_.num_pixels(),
      kGrain,
      ComposeGlass{inputs(layers), options_.linear_light, image_.on_device()}
  );
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
          dL_dimage.on_device(),
          dL_dlayers_.interface.on_device(),
          dL_dlayers_.transmission.on_device(),
          dL_dlayers_.reflection.on_device(),
          dL_dtransparency_.on_device(),
          dL_dmirrored_.on_device()}
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
          interface.features.on_device(),
          interface.alpha.on_device(),
          interface.depth_sum.on_device(),
          interface.normal.on_device(),
          buffer_.normal.on_device(),
          buffer_.specular.on_device(),
          buffer_.fresnel.on_device(),
          dL_dlayers_.interface.on_device(),
          dL_dtransparency_.on_device(),
          dL_dmirrored_.on_device(),
          dL_dtransparency.on_device(),
          dL_drays == nullptr ? nullptr : dL_drays->origins.array().device_for_reading(),
          dL_drays == nullptr ? nullptr : dL_drays->directions.array().device_for_reading(),
          dL_dinterface.features.on_device(),
          dL_dinterface.depth_sum.on_device(),
          dL_dinterface.alpha.on_device(),
          dL_dinterface.normal.on_device()}
  );
}

Image part_of_picture(
    const Image& picture, const Image& layer, const Image& weight, bool linear_light
) {
  Image part = layer;
  for (std::size_t i = 0; i < part.values().size(); ++i) {
    const float w = weight.data()[i / 3];
    float& value = part.values()[i];
    value = linear_light ? displayed_part(picture.data()[i], value, w) : value * w;
  }
  return part;
}

}  // namespace glint
