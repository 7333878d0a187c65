// SPDX-License-Identifier: MIT
// Deferred shading of Ref-GS, pixel by pixel.
#pragma once

#include "glint/core/kernel.h"
#include "glint/render/activations.h"
#include "glint/render/tone.h"

namespace glint {

// alpha displayed(albedo + specular) + (1 - alpha) background, specular = e^min(x, 5) of the
// network's outputs x.
template <class T>
GLINT_HD Vec3<T> specular_radiance(Vec3<T> x) {
  return {exp_to_cap(x.x), exp_to_cap(x.y), exp_to_cap(x.z)};
}
template <class T>
GLINT_HD Vec3<T> specular_radiance_vjp(Vec3<T> x, Vec3<T> value, Vec3<T> g) {
  return {
      capped_exp_vjp(x.x, value.x, g.x),
      capped_exp_vjp(x.y, value.y, g.y),
      capped_exp_vjp(x.z, value.z, g.z)};
}
template <class T>
GLINT_HD Vec3<T> deferred_color(T alpha, Vec3<T> background, Vec3<T> albedo, Vec3<T> x) {
  return alpha * displayed(albedo + specular_radiance(x)) + (T(1) - alpha) * background;
}
template <class T>
GLINT_HD void deferred_color_vjp(
    T alpha,
    Vec3<T> background,
    Vec3<T> albedo,
    Vec3<T> x,
    Vec3<T> dL_dcolor,
    T& dL_dalpha,
    Vec3<T>& dL_dalbedo,
    Vec3<T>& dL_dx
) {
  const Vec3<T> specular = specular_radiance(x);
  dL_dalpha += dot(dL_dcolor, displayed(albedo + specular) - background);
  const Vec3<T> g = displayed_vjp(albedo + specular, alpha * dL_dcolor);
  dL_dalbedo += g;
  dL_dx += specular_radiance_vjp(x, specular, g);
}

// What a pixel is made of. directions: zero where it is not shaded, and then black in front of the
// background.
struct DeferredPixels {
  int channels, albedo;  // of the features; where albedo begins
  const float *features, *alpha, *directions;
  const float* outputs;  // of the network, [pixels][3]
  Vec3f background;

  GLINT_HD bool shaded(std::size_t i) const { return length2(get3(directions, i)) > 0; }
  GLINT_HD std::size_t albedo_at(std::size_t i) const {
    return i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(albedo);
  }
  GLINT_HD Vec3f albedo_of(std::size_t i) const { return get3(features + albedo_at(i), 0); }
};

struct ShadeDeferred {
  DeferredPixels pixels;
  float* image;
  GLINT_HD void operator()(std::size_t i) const {
    const float alpha = pixels.alpha[i];
    const Vec3f color =
        deferred_color(alpha, pixels.background, pixels.albedo_of(i), get3(pixels.outputs, i));
    put3(image, i, pixels.shaded(i) ? color : (1 - alpha) * pixels.background);
  }
};
struct ShadeDeferredVjp {
  DeferredPixels pixels;
  const float* dL_dimage;
  float *dL_dfeatures, *dL_dalpha;  // added to
  float* dL_doutputs;

  GLINT_HD void operator()(std::size_t i) const {
    const Vec3f dL_dcolor = get3(dL_dimage, i);
    Vec3f dL_dalbedo{}, dL_dx{};
    float dL_da = 0;
    if (pixels.shaded(i))
      deferred_color_vjp(
          pixels.alpha[i],
          pixels.background,
          pixels.albedo_of(i),
          get3(pixels.outputs, i),
          dL_dcolor,
          dL_da,
          dL_dalbedo,
          dL_dx
      );
    else
      dL_da = -dot(dL_dcolor, pixels.background);
    dL_dalpha[i] += dL_da;
    float* g = dL_dfeatures + pixels.albedo_at(i);
    put3(g, 0, get3(g, 0) + dL_dalbedo);
    put3(dL_doutputs, i, dL_dx);
  }
};

// Diffuse and specular part, each as if it were alone.
struct DeferredParts {
  DeferredPixels pixels;
  float *diffuse, *specular;
  GLINT_HD void operator()(std::size_t i) const {
    const bool shaded = pixels.shaded(i);
    const Vec3f light = specular_radiance(get3(pixels.outputs, i));
    put3(diffuse, i, shaded ? displayed(pixels.albedo_of(i)) : Vec3f{});
    put3(specular, i, shaded ? displayed(light) : Vec3f{});
  }
};

using RefGsKernels = KernelList<ShadeDeferred, ShadeDeferredVjp, DeferredParts>;

}  // namespace glint
