// SPDX-License-Identifier: MIT
#include "glint/train/glass_transport.h"

#include <algorithm>

#include "glint/core/parallel.h"
#include "glint/render/blend.h"
#include "glint/render/transport.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 1024;   // pixels a block
constexpr float kLeastNormal = 1e-6f;  // of a composited normal that has a direction

void fit(Image& image, ImageSize size, int channels) {
  if (image.size() != size || image.channels() != channels)
    image = Image(size.width, size.height, channels);
}
Vec3f get3(const Image& image, std::size_t i) {
  if (image.empty()) return {};
  const float* p = image.data() + 3 * i;
  return {p[0], p[1], p[2]};
}
void put3(Image& image, std::size_t i, Vec3f v) {
  float* p = image.data() + 3 * i;
  p[0] = v.x;
  p[1] = v.y;
  p[2] = v.z;
}
void add3(Image& image, std::size_t i, Vec3f v) { put3(image, i, get3(image, i) + v); }

// The camera ray of a pixel: camera space with z = 1, its length, world space.
struct PixelRay {
  Vec3f in_cam;
  float norm;
  Vec3f unit() const { return (1 / norm) * in_cam; }
};
PixelRay pixel_ray(const Camera& camera, std::size_t i) {
  const auto width = static_cast<std::size_t>(camera.width);
  const auto x = static_cast<double>(i % width) + 0.5, y = static_cast<double>(i / width) + 0.5;
  const Vec3f d = cast<float>(camera.ray_in_cam(x, y));
  return {d, length(d)};
}

}  // namespace

Rays camera_rays(const Camera& camera) {
  const ImageSize size = camera.size();
  Rays rays{Image(size.width, size.height, 3), Image(size.width, size.height, 3)};
  const Mat3f rotation = cast<float>(camera.rotation_cam_from_world);
  for (std::size_t i = 0; i < size.num_pixels(); ++i) {
    put3(rays.origins, i, cast<float>(camera.center()));
    put3(rays.directions, i, transpose_times(rotation, pixel_ray(camera, i).in_cam));
  }
  return rays;
}

void copy_color(const Image& features, Image& color) {
  fit(color, features.size(), 3);
  for (std::size_t i = 0; i < color.num_pixels(); ++i)
    std::copy_n(features.data() + i * features.channels(), 3, color.data() + 3 * i);
}

const GlassBuffer&
GlassTransport::read_interface(const Camera& camera, const RasterOutput& interface) {
  const ImageSize size = camera.size();
  const auto channels = static_cast<std::size_t>(interface.features.channels());
  for (Image* image :
       {&buffer_.depth,
        &buffer_.transparency,
        &buffer_.specular,
        &buffer_.fresnel,
        &buffer_.mirrored})
    fit(*image, size, 1);
  for (Image* image : {&buffer_.normal, &buffer_.reflected.origins, &buffer_.reflected.directions})
    fit(*image, size, 3);
  const Mat3f rotation = cast<float>(camera.rotation_cam_from_world);
  const Vec3f eye = cast<float>(camera.center());
  parallel_for(size.num_pixels(), kGrain, [&](std::size_t i) {
    const float* features = interface.features.data() + channels * i;
    const float alpha = interface.alpha.data()[i];
    const float z = expected_depth(interface.depth_sum.data()[i], alpha);
    const Vec3f raw = get3(interface.normal, i);
    const float norm = length(raw);
    const bool hit = z > 0 && norm > kLeastNormal;
    const Vec3f n = hit ? (1 / norm) * raw : Vec3f{};
    const PixelRay ray = pixel_ray(camera, i);
    const float specular = features[channels - 1];
    const float fresnel = keep(options_.fresnel, schlick(options_.f0, -dot(n, ray.unit())));
    buffer_.depth.data()[i] = z;
    put3(buffer_.normal, i, n);
    buffer_.transparency.data()[i] = options_.transmission ? features[kTransparencyChannel] : 0.0f;
    buffer_.specular.data()[i] = specular;
    buffer_.fresnel.data()[i] = fresnel;
    buffer_.mirrored.data()[i] =
        keep(hit && options_.reflection, mirrored_share(specular, fresnel));
    const Vec3f w = hit ? mirrored_direction(ray.unit(), n) : Vec3f{};
    put3(buffer_.reflected.origins, i, eye + transpose_times(rotation, z * ray.in_cam));
    put3(buffer_.reflected.directions, i, transpose_times(rotation, w));
  });
  return buffer_;
}

const Image& GlassTransport::compose(const GlassLayers& layers) {
  fit(image_, buffer_.depth.size(), 3);
  parallel_for(image_.num_pixels(), kGrain, [&](std::size_t i) {
    const GlassRadiance<float> pixel{
        get3(layers.interface, i),
        get3(layers.transmission, i),
        get3(layers.reflection, i),
        buffer_.transparency.data()[i],
        buffer_.mirrored.data()[i]};
    put3(image_, i, outgoing_radiance(pixel));
  });
  return image_;
}

const GlassLayers& GlassTransport::compose_vjp(const GlassLayers& layers, const Image& dL_dimage) {
  const ImageSize size = buffer_.depth.size();
  for (Image* image : {&dL_dlayers_.interface, &dL_dlayers_.transmission, &dL_dlayers_.reflection})
    fit(*image, size, 3);
  fit(dL_dtransparency_, size, 1);
  fit(dL_dmirrored_, size, 1);
  parallel_for(size.num_pixels(), kGrain, [&](std::size_t i) {
    const GlassRadiance<float> pixel{
        get3(layers.interface, i),
        get3(layers.transmission, i),
        get3(layers.reflection, i),
        buffer_.transparency.data()[i],
        buffer_.mirrored.data()[i]};
    const GlassRadiance<float> g = outgoing_radiance_vjp(pixel, get3(dL_dimage, i));
    put3(dL_dlayers_.interface, i, g.interface);
    put3(dL_dlayers_.transmission, i, g.transmission);
    put3(dL_dlayers_.reflection, i, g.reflection);
    dL_dtransparency_.data()[i] = keep(options_.transmission, g.transparency);
    dL_dmirrored_.data()[i] = keep(options_.reflection, g.mirrored);
  });
  return dL_dlayers_;
}

void GlassTransport::interface_vjp(
    const Camera& camera,
    const RasterOutput& interface,
    const Rays* dL_drays,
    const Image& dL_dtransparency,
    RasterOutputGradient& dL_dinterface
) const {
  const auto channels = static_cast<std::size_t>(dL_dinterface.features.channels());
  const bool has_transparency = channels == kInterfaceChannels;
  const Mat3f rotation = cast<float>(camera.rotation_cam_from_world);
  parallel_for(buffer_.depth.num_pixels(), kGrain, [&](std::size_t i) {
    float* dL_dfeatures = dL_dinterface.features.data() + channels * i;
    for (int c = 0; c < 3; ++c) dL_dfeatures[c] += dL_dlayers_.interface.data()[3 * i + c];
    if (has_transparency) dL_dfeatures[kTransparencyChannel] += dL_dtransparency_.data()[i];
    if (has_transparency && !dL_dtransparency.empty())
      dL_dfeatures[kTransparencyChannel] += dL_dtransparency.data()[i];
    const Vec3f n = get3(buffer_.normal, i);
    if (!options_.reflection || length2(n) == 0) return;
    const PixelRay ray = pixel_ray(camera, i);
    const float s = buffer_.specular.data()[i], fresnel = buffer_.fresnel.data()[i];
    float dL_dfresnel = 0;
    mirrored_share_vjp(
        s, fresnel, dL_dmirrored_.data()[i], dL_dfeatures[channels - 1], dL_dfresnel
    );
    dL_dfresnel = keep(options_.fresnel, dL_dfresnel);
    Vec3f dL_dn = -schlick_vjp(options_.f0, -dot(n, ray.unit()), dL_dfresnel) * ray.unit();
    if (dL_drays != nullptr) {
      const Vec3f dL_dw = rotation * get3(dL_drays->directions, i);
      mirrored_direction_vjp(ray.unit(), n, dL_dw, dL_dn);
      const Vec3f dL_dx = rotation * get3(dL_drays->origins, i);
      if (!options_.detach_origins)
        expected_depth_vjp(
            interface.depth_sum.data()[i],
            interface.alpha.data()[i],
            dot(dL_dx, ray.in_cam),
            dL_dinterface.depth_sum.data()[i],
            dL_dinterface.alpha.data()[i]
        );
    }
    const float norm = length(get3(interface.normal, i));
    add3(dL_dinterface.normal, i, normalize_vjp(n, norm, dL_dn));
  });
}

}  // namespace glint
