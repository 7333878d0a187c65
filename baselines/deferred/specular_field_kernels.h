// SPDX-License-Identifier: MIT
// SpecularField, pixel by pixel.
#pragma once

#include "glint/core/kernel.h"
#include "glint/render/glass_kernels.h"

namespace glint {

// Where rasterised features have roughness (one channel) and the specular feature (the first of
// kSpecularFeature).
inline constexpr int kSpecularFeature = 4;
struct SpecularChannels {
  int roughness = 0, feature = 0;
};

// f / |f| of a composited feature; shorter ones than this are divided by it instead, so that no
// gradient grows beyond its inverse.
inline constexpr float kMinFeatureLength = 1e-3f;
template <class T>
struct FeatureDirection {
  T unit[kSpecularFeature];
  T norm;  // at least kMinFeatureLength

  GLINT_HD static FeatureDirection of(const T feature[kSpecularFeature]) {
    T sum(0);
    for (int k = 0; k < kSpecularFeature; ++k) sum = fma_of(feature[k], feature[k], sum);
    FeatureDirection result;
    result.norm = max_of(sqrt_of(sum), T(kMinFeatureLength));
    for (int k = 0; k < kSpecularFeature; ++k) result.unit[k] = feature[k] / result.norm;
    return result;
  }
  // Adds dL/d(feature).
  GLINT_HD void vjp(const T dL_dunit[kSpecularFeature], T dL_dfeature[kSpecularFeature]) const {
    T radial(0);
    for (int k = 0; k < kSpecularFeature; ++k) radial = fma_of(unit[k], dL_dunit[k], radial);
    radial = keep(norm > T(kMinFeatureLength), radial);
    for (int k = 0; k < kSpecularFeature; ++k)
      dL_dfeature[k] += (dL_dunit[k] - unit[k] * radial) / norm;
  }
};

// The network's input: outer product of a direction's code [codes] and the feature's direction,
// then the code itself [Ref-GS]; codes (kSpecularFeature + 1) numbers.
template <class T>
GLINT_HD void specular_input(
    const T* code, int codes, const FeatureDirection<T>& feature, T* input
) {
  for (int c = 0; c < codes; ++c) {
    for (int k = 0; k < kSpecularFeature; ++k)
      input[c * kSpecularFeature + k] = code[c] * feature.unit[k];
    input[codes * kSpecularFeature + c] = code[c];
  }
}
// Writes dL/d(code), adds dL/d(feature's direction).
template <class T>
GLINT_HD void specular_input_vjp(
    const T* code,
    int codes,
    const FeatureDirection<T>& feature,
    const T* dL_dinput,
    T* dL_dcode,
    T dL_dunit[kSpecularFeature]
) {
  for (int c = 0; c < codes; ++c) {
    const T* g = dL_dinput + c * kSpecularFeature;
    T sum = dL_dinput[codes * kSpecularFeature + c];
    for (int k = 0; k < kSpecularFeature; ++k) {
      sum = fma_of(g[k], feature.unit[k], sum);
      dL_dunit[k] = fma_of(g[k], code[c], dL_dunit[k]);
    }
    dL_dcode[c] = sum;
  }
}

// Mirrored directions in the world; zero where alpha is too small or there is no normal.
struct SpecularDirections {
  PixelRays rays;
  float min_alpha;
  int channels, roughness;
  const float *features, *alpha, *normal;  // rasterised; camera space
  float *directions, *roughness_map;

  GLINT_HD void operator()(std::size_t i) const {
    const Vec3f n = unit_normal(get3(normal, i));
    const bool shaded = alpha[i] > min_alpha && length2(n) > 0;
    const Vec3f w = shaded ? mirrored_direction(rays.at(i).unit(), n) : Vec3f{};
    put3(directions, i, transpose_times(rays.rotation, w));
    roughness_map[i] =
        features[i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(roughness)];
  }
};
struct SpecularDirectionsVjp {
  PixelRays rays;
  int channels, roughness;
  const float *directions, *normal, *dL_ddirections, *dL_droughness;
  float *dL_dfeatures, *dL_dnormal;  // added to

  GLINT_HD void operator()(std::size_t i) const {
    if (length2(get3(directions, i)) == 0) return;
    const Vec3f raw = get3(normal, i);
    Vec3f dL_dn{}, dL_draw{};
    mirrored_direction_vjp(
        rays.at(i).unit(), unit_normal(raw), rays.rotation * get3(dL_ddirections, i), dL_dn
    );
    unit_normal_vjp(raw, dL_dn, dL_draw);
    put3(dL_dnormal, i, get3(dL_dnormal, i) + dL_draw);
    dL_dfeatures[i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(roughness)] +=
        dL_droughness[i];
  }
};

struct SpecularInputs {
  int codes, channels, feature;
  const float *code, *features;
  float* inputs;  // [pixels][codes (kSpecularFeature + 1)]

  GLINT_HD void operator()(std::size_t i) const {
    const float* f = features + i * static_cast<std::size_t>(channels) + feature;
    specular_input(
        code + i * static_cast<std::size_t>(codes),
        codes,
        FeatureDirection<float>::of(f),
        inputs + i * static_cast<std::size_t>(codes * (kSpecularFeature + 1))
    );
  }
};
struct SpecularInputsVjp {
  int codes, channels, feature;
  const float *code, *features, *dL_dinputs;
  float* dL_dcode;
  float* dL_dfeatures;  // added to

  GLINT_HD void operator()(std::size_t i) const {
    const std::size_t at =
        i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(feature);
    const std::size_t row = i * static_cast<std::size_t>(codes);
    const auto direction = FeatureDirection<float>::of(features + at);
    float dL_dunit[kSpecularFeature] = {};
    specular_input_vjp(
        code + row,
        codes,
        direction,
        dL_dinputs + row * static_cast<std::size_t>(kSpecularFeature + 1),
        dL_dcode + row,
        dL_dunit
    );
    direction.vjp(dL_dunit, dL_dfeatures + at);
  }
};

using SpecularFieldKernels =
    KernelList<SpecularDirections, SpecularDirectionsVjp, SpecularInputs, SpecularInputsVjp>;

}  // namespace glint
