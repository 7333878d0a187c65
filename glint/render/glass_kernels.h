// SPDX-License-Identifier: MIT
// GlassTransport, pixel by pixel.
#pragma once

#include "glint/core/kernel.h"
#include "glint/render/blend.h"
#include "glint/render/depth_normal.h"
#include "glint/render/transport.h"

namespace glint {

// Where an interface set's features have t and s, behind its colour.
struct InterfaceChannels {
  static constexpr int kNone = -1;  // counts as 0
  int transparency = kNone, specular = kNone;
};
GLINT_HD float feature_or_zero(const float* feature, int channel) {
  return channel < 0 ? 0.0f : feature[channel];
}

struct GlassOptions {
  InterfaceChannels channels;
  float f0 = kGlassF0;          // of Fresnel's term
  float glass_f0 = kGlassF0;    // of panes
  bool transmission = true;     // off: t counts as 0
  bool reflection = true;       // off: k_s counts as 0
  bool detach_origins = false;  // no gradient from reflections to the interface's depth
  bool fresnel = true;          // off: k_s = s, for methods without it
  bool opaque_fresnel = true;   // off: none but panes have it
  bool linear_light = false;    // layers are added as linear values, not as displayed ones

  GLINT_HD float f0_at(float t) const { return is_glass(t) ? glass_f0 : f0; }
};

// Zero where there is no such map.
GLINT_HD Vec3f map3(const float* image, std::size_t i) {
  return image == nullptr ? Vec3f{} : get3(image, i);
}

// The camera ray of a pixel: camera space with z = 1, and its length.
struct PixelRay {
  Vec3f in_cam;
  float norm;
  GLINT_HD Vec3f unit() const { return (1 / norm) * in_cam; }
};
// Of all pixels of a camera.
struct PixelRays {
  double fx, fy, cx, cy;
  std::size_t width;
  Mat3f rotation;  // camera from world
  Vec3f eye;       // world

  GLINT_HD PixelRay at(std::size_t i) const {
    const double x = static_cast<double>(i % width) + 0.5, y = static_cast<double>(i / width) + 0.5;
    const Vec3f d{static_cast<float>((x - cx) / fx), static_cast<float>((y - cy) / fy), 1.0f};
    return {d, length(d)};
  }
};

struct CameraRays {
  PixelRays rays;
  float *origins, *directions;
  GLINT_HD void operator()(std::size_t i) const {
    put3(origins, i, rays.eye);
    put3(directions, i, transpose_times(rays.rotation, rays.at(i).in_cam));
  }
};

// Maps of a GlassBuffer.
struct GlassMaps {
  float *depth, *normal, *transparency, *specular, *fresnel, *mirrored, *origins, *directions;
};

struct ReadInterface {
  PixelRays rays;
  GlassOptions options;
  int channels;
  const float *features, *alpha, *depth_sum, *normal;
  GlassMaps out;

  GLINT_HD void operator()(std::size_t i) const {
    const float* feature = features + static_cast<std::size_t>(channels) * i;
    const float z = expected_depth(depth_sum[i], alpha[i]);
    const Vec3f raw = map3(normal, i);
    const float norm = length(raw);
    const bool hit = z > 0 && norm > kMinNormalLength;
    const Vec3f n = hit ? (1 / norm) * raw : Vec3f{};
    const PixelRay ray = rays.at(i);
    const float specular = feature_or_zero(feature, options.channels.specular);
    const float t = feature_or_zero(feature, options.channels.transparency);
    const bool has_fresnel = options.fresnel && (options.opaque_fresnel || is_glass(t));
    const float fresnel = keep(has_fresnel, schlick(options.f0_at(t), -dot(n, ray.unit())));
    out.depth[i] = z;
    put3(out.normal, i, n);
    out.transparency[i] = options.transmission ? t : 0.0f;
    out.specular[i] = specular;
    out.fresnel[i] = fresnel;
    out.mirrored[i] = keep(hit && options.reflection, mirrored_share(specular, fresnel));
    const Vec3f w = hit ? mirrored_direction(ray.unit(), n) : Vec3f{};
    put3(out.origins, i, rays.eye + transpose_times(rays.rotation, z * ray.in_cam));
    put3(out.directions, i, transpose_times(rays.rotation, w));
  }
};

// What the picture is made of; layers that are switched off may be null.
struct GlassInputs {
  const float *interface, *transmission, *reflection;  // [H][W][3]
  const float *transparency, *mirrored;                // [H][W][1]
  GLINT_HD GlassRadiance<float> at(std::size_t i) const {
    return {
        map3(interface, i),
        map3(transmission, i),
        map3(reflection, i),
        transparency[i],
        mirrored[i]};
  }
};

struct ComposeGlass {
  GlassInputs in;
  bool linear_light;
  float* image;
  GLINT_HD void operator()(std::size_t i) const {
    const GlassRadiance<float> p = in.at(i);
    put3(image, i, linear_light ? outgoing_displayed(p) : outgoing_radiance(p));
  }
};

struct ComposeGlassVjp {
  GlassInputs in;
  GlassOptions options;
  const float* dL_dimage;
  float *dL_dinterface, *dL_dtransmission, *dL_dreflection, *dL_dtransparency, *dL_dmirrored;

  GLINT_HD void operator()(std::size_t i) const {
    const GlassRadiance<float> p = in.at(i);
    const Vec3f dL_dpixel = map3(dL_dimage, i);
    const GlassRadiance<float> g = options.linear_light ? outgoing_displayed_vjp(p, dL_dpixel)
                                                        : outgoing_radiance_vjp(p, dL_dpixel);
    put3(dL_dinterface, i, g.interface);
    put3(dL_dtransmission, i, g.transmission);
    put3(dL_dreflection, i, g.reflection);
    dL_dtransparency[i] = keep(options.transmission, g.transparency);
    dL_dmirrored[i] = keep(options.reflection, g.mirrored);
  }
};

struct ReadInterfaceVjp {
  PixelRays rays;
  GlassOptions options;
  int channels;
  const float *features, *alpha, *depth_sum, *raw_normal;        // of the interface
  const float *normal, *specular, *fresnel;                      // of the buffer
  const float *dL_dcolor, *dL_dt, *dL_dmirrored;                 // of compose()
  const float *dL_dmap_t, *dL_dorigins, *dL_ddirections;         // may be null
  float *dL_dfeatures, *dL_ddepth_sum, *dL_dalpha, *dL_dnormal;  // added to

  GLINT_HD void operator()(std::size_t i) const {
    float* feature = dL_dfeatures + static_cast<std::size_t>(channels) * i;
    for (std::size_t c = 0; c < 3; ++c) feature[c] += dL_dcolor[3 * i + c];
    if (options.channels.transparency >= 0) {
      float& dL_dfeature = feature[options.channels.transparency];
      dL_dfeature += dL_dt[i];
      if (dL_dmap_t != nullptr) dL_dfeature += dL_dmap_t[i];
    }
    const Vec3f n = map3(normal, i);
    if (!options.reflection || length2(n) == 0) return;
    const PixelRay ray = rays.at(i);
    float dL_dfresnel = 0, dL_dspecular = 0;
    mirrored_share_vjp(specular[i], fresnel[i], dL_dmirrored[i], dL_dspecular, dL_dfresnel);
    if (options.channels.specular >= 0) feature[options.channels.specular] += dL_dspecular;
    dL_dfresnel = keep(fresnel[i] > 0, dL_dfresnel);  // 0 is none: F is at least f0
    const float* read = features + static_cast<std::size_t>(channels) * i;
    const float f0 = options.f0_at(feature_or_zero(read, options.channels.transparency));
    Vec3f dL_dn = -schlick_vjp(f0, -dot(n, ray.unit()), dL_dfresnel) * ray.unit();
    if (dL_dorigins != nullptr) through_rays(i, ray, n, dL_dn);
    const float norm = length(map3(raw_normal, i));
    put3(dL_dnormal, i, map3(dL_dnormal, i) + normalize_vjp(n, norm, dL_dn));
  }

 private:
  GLINT_HD void through_rays(std::size_t i, const PixelRay& ray, Vec3f n, Vec3f& dL_dn) const {
    mirrored_direction_vjp(ray.unit(), n, rays.rotation * map3(dL_ddirections, i), dL_dn);
    if (options.detach_origins) return;
    const Vec3f dL_dx = rays.rotation * map3(dL_dorigins, i);
    expected_depth_vjp(
        depth_sum[i], alpha[i], dot(dL_dx, ray.in_cam), dL_ddepth_sum[i], dL_dalpha[i]
    );
  }
};

using GlassKernels =
    KernelList<CameraRays, ReadInterface, ComposeGlass, ComposeGlassVjp, ReadInterfaceVjp>;

}  // namespace glint
