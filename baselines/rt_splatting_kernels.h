// SPDX-License-Identifier: MIT
// RT-Splatting, pixel by pixel: composition and the losses of its masks, each formula with its vjp.
#pragma once

#include "glint/core/kernel.h"
#include "glint/render/activations.h"
#include "glint/train/pixel_losses.h"

namespace glint {

// How much of a pixel there is yet.
enum class RtStage : int { kTransmission, kNoSpecular, kAll };
inline constexpr int kRtStages = 3;

// Of the surface pass and the volume pass, and the network's four outputs.
inline constexpr int kRtOutputs = 4;
template <class T>
struct RtPixel {
  Vec3<T> transmission, scattered;
  T transmissivity, reflectance;
  Vec3<T> specular;  // raw: e^min(x, 5) / 2 is the light
  T attenuation;     // raw: its sigmoid
};

template <class T>
GLINT_HD Vec3<T> rt_specular(Vec3<T> x) {
  const T scale(0.5f * kExpCap);  // capped_exp has 1/5 of e^x
  return {scale * capped_exp(x.x), scale * capped_exp(x.y), scale * capped_exp(x.z)};
}
template <class T>
GLINT_HD Vec3<T> rt_specular_vjp(Vec3<T> x, Vec3<T> value, Vec3<T> g) {
  return {
      capped_exp_vjp(x.x, value.x, g.x),
      capped_exp_vjp(x.y, value.y, g.y),
      capped_exp_vjp(x.z, value.z, g.z)};
}

// a [t Tran + (1 - t) Scat] + r spec, a = 1 - (1 - sigmoid(attenuation)) sg(t): what is not
// transparent is not attenuated.
template <class T>
GLINT_HD T rt_attenuation(const RtPixel<T>& p) {
  return T(1) - (T(1) - sigmoid(p.attenuation)) * p.transmissivity;
}
template <class T>
GLINT_HD Vec3<T> rt_base(const RtPixel<T>& p) {
  return p.transmissivity * p.transmission + (T(1) - p.transmissivity) * p.scattered;
}
template <class T>
GLINT_HD Vec3<T> rt_color(const RtPixel<T>& p, RtStage stage) {
  if (stage == RtStage::kTransmission) return p.transmission;
  if (stage == RtStage::kNoSpecular) return rt_base(p);
  return rt_attenuation(p) * rt_base(p) + p.reflectance * rt_specular(p.specular);
}
template <class T>
GLINT_HD RtPixel<T> rt_color_vjp(const RtPixel<T>& p, RtStage stage, Vec3<T> g) {
  RtPixel<T> result{};
  if (stage == RtStage::kTransmission) {
    result.transmission = g;
    return result;
  }
  const bool all = stage == RtStage::kAll;
  const Vec3<T> dL_dbase = (all ? rt_attenuation(p) : T(1)) * g;
  result.transmission = p.transmissivity * dL_dbase;
  result.scattered = (T(1) - p.transmissivity) * dL_dbase;
  result.transmissivity = dot(dL_dbase, p.transmission - p.scattered);
  if (!all) return result;
  const Vec3<T> light = rt_specular(p.specular);
  result.reflectance = dot(g, light);
  result.specular = rt_specular_vjp(p.specular, light, p.reflectance * g);
  result.attenuation = sigmoid_vjp(sigmoid(p.attenuation), p.transmissivity * dot(g, rt_base(p)));
  return result;
}

// Where the surface pass's features have them, behind the colour.
inline constexpr int kRtOpacity = 3, kRtTransmissivity = 4, kRtReflectance = 5, kRtRoughness = 6,
                     kRtFeature = 7, kRtChannels = 11;

// Surface features are null, and the network's outputs and directions, in stages without them.
struct RtPixels {
  RtStage stage;
  const float* transmission;          // [pixels][3]
  const float* surface;               // [pixels][kRtChannels]
  const float *outputs, *directions;  // [pixels][kRtOutputs], [pixels][3]; zero: not shaded

  GLINT_HD RtStage stage_at(std::size_t i) const {
    const bool shaded = stage == RtStage::kAll && length2(get3(directions, i)) > 0;
    return stage == RtStage::kAll && !shaded ? RtStage::kNoSpecular : stage;
  }
  GLINT_HD RtPixel<float> at(std::size_t i) const {
    RtPixel<float> p{};
    p.transmission = get3(transmission, i);
    if (stage == RtStage::kTransmission) return p;
    const float* s = surface + i * static_cast<std::size_t>(kRtChannels);
    p.scattered = get3(s, 0);
    p.transmissivity = s[kRtTransmissivity];
    p.reflectance = s[kRtReflectance];
    if (stage == RtStage::kNoSpecular) return p;
    const float* x = outputs + i * static_cast<std::size_t>(kRtOutputs);
    p.specular = get3(x, 0);
    p.attenuation = x[3];
    return p;
  }
};

struct RtCompose {
  RtPixels pixels;
  float* image;
  GLINT_HD void operator()(std::size_t i) const {
    put3(image, i, rt_color(pixels.at(i), pixels.stage_at(i)));
  }
};
struct RtComposeVjp {
  RtPixels pixels;
  const float* dL_dimage;
  const float* kept;  // [pixels] share of the transmission's gradient; null: all
  float* dL_dtransmission;
  float *dL_dsurface, *dL_doutputs;  // the first is added to; null in stages without them

  GLINT_HD void operator()(std::size_t i) const {
    const RtPixel<float> g = rt_color_vjp(pixels.at(i), pixels.stage_at(i), get3(dL_dimage, i));
    put3(dL_dtransmission, i, (kept == nullptr ? 1.0f : kept[i]) * g.transmission);
    if (pixels.stage == RtStage::kTransmission) return;
    float* s = dL_dsurface + i * static_cast<std::size_t>(kRtChannels);
    put3(s, 0, get3(s, 0) + g.scattered);
    s[kRtTransmissivity] += g.transmissivity;
    s[kRtReflectance] += g.reflectance;
    if (pixels.stage == RtStage::kNoSpecular) return;
    float* x = dL_doutputs + i * static_cast<std::size_t>(kRtOutputs);
    put3(x, 0, g.specular);
    x[3] = g.attenuation;
  }
};

// Specular light of a pixel; one number of it, the mean of its channels.
struct RtSpecular {
  RtPixels pixels;
  float *light, *mean;  // [pixels][3], [pixels]
  GLINT_HD void operator()(std::size_t i) const {
    const bool shaded = pixels.stage_at(i) == RtStage::kAll;
    const Vec3f spec = shaded ? rt_specular(pixels.at(i).specular) : Vec3f{};
    put3(light, i, spec);
    mean[i] = (spec.x + spec.y + spec.z) / 3;
  }
};
// e^(-4 std) of a map in windows of 7x7 pixels, cut off at the border.
struct RtKeptShare {
  ImageView map;
  float* kept;
  GLINT_HD void operator()(std::size_t i) const {
    constexpr int kRadius = 3;
    const auto width = static_cast<std::size_t>(map.width);
    const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
    float count = 0, sum = 0, squares = 0;
    const float here = map.at(x, y);  // relative to it: less cancellation
    for (int v = y - kRadius; v <= y + kRadius; ++v)
      for (int u = x - kRadius; u <= x + kRadius; ++u) {
        if (u < 0 || v < 0 || u >= map.width || v >= map.height) continue;
        const float value = map.at(u, v) - here;
        count += 1;
        sum += value;
        squares += value * value;
      }
    const float mean = sum / count;
    kept[i] = exp_fast(-4 * sqrt_of(max_of(squares / count - mean * mean, 0.0f)));
  }
};

// Sums over the pixels of the mask, of t and Scat.
struct RtMoments {
  double count = 0;
  double sum[4] = {}, squares[4] = {};
  GLINT_HD RtMoments& operator+=(const RtMoments& other) {
    count += other.count;
    for (int k = 0; k < 4; ++k) {
      sum[k] += other.sum[k];
      squares[k] += other.squares[k];
    }
    return *this;
  }
  GLINT_HD double mean(int k) const { return count == 0 ? 0 : sum[k] / count; }
  double variance() const {  // of all four together
    double total = 0;
    for (int k = 0; k < 4; ++k) total += count == 0 ? 0 : squares[k] / count - mean(k) * mean(k);
    return total;
  }
};
GLINT_HD float rt_varying(const float* surface, int k) {
  return surface[k < 3 ? k : kRtTransmissivity];
}
struct RtMaskMoments {
  ImageView surface, mask;
  GLINT_HD RtMoments operator()(int x, int y) const {
    RtMoments m;
    if (mask.at(x, y) <= 0.5f) return m;
    m.count = 1;
    for (int k = 0; k < 4; ++k) {
      m.sum[k] = static_cast<double>(rt_varying(surface.pixel(x, y), k));
      m.squares[k] = m.sum[k] * m.sum[k];
    }
    return m;
  }
};

// What the variance inside the mask needs: means, and its weight over the number of pixels.
struct RtInside {
  float mean[4], weight_variance;
};
struct RtFindInside {
  const RtMoments* moments;
  float lambda_variance;
  RtInside* inside;
  GLINT_HD void operator()(std::size_t) const {
    for (int k = 0; k < 4; ++k) inside->mean[k] = static_cast<float>(moments->mean(k));
    inside->weight_variance = lambda_variance / static_cast<float>(max_of(moments->count, 1.0));
  }
};

// BCE(1 - opacity, mask) + BCE(t, 0) outside the mask, and the gradient of the mean of both and of
// the variance inside (means given), each with its weight over the number of pixels it is taken of.
struct RtMaskLoss {
  ImageView surface, mask;
  const RtInside* inside_mask;
  float weight_opacity, weight_outside;
  ImageRef dL_dsurface;  // added to

  GLINT_HD double operator()(int x, int y) const {
    const float* s = surface.pixel(x, y);
    float* g = dL_dsurface.pixel(x, y);
    const float inside = mask.at(x, y) > 0.5f ? 1.0f : 0.0f;
    float dL_dq = 0;
    const float through = 1 - s[kRtOpacity];
    binary_cross_entropy_vjp(through, inside, weight_opacity, dL_dq);
    g[kRtOpacity] -= dL_dq;
    double loss = static_cast<double>(weight_opacity * binary_cross_entropy(through, inside));
    if (inside > 0) {
      for (int k = 0; k < 4; ++k)
        g[k < 3 ? k : kRtTransmissivity] +=
            2 * inside_mask->weight_variance * (rt_varying(s, k) - inside_mask->mean[k]);
      return loss;
    }
    binary_cross_entropy_vjp(s[kRtTransmissivity], 0.0f, weight_outside, g[kRtTransmissivity]);
    loss += static_cast<double>(weight_outside * binary_cross_entropy(s[kRtTransmissivity], 0.0f));
    return loss;
  }
};

// One channel of the surface pass.
struct RtChannel {
  const float* surface;
  int channel;
  float* map;
  GLINT_HD void operator()(std::size_t i) const {
    map[i] = surface[i * static_cast<std::size_t>(kRtChannels) + static_cast<std::size_t>(channel)];
  }
};

using RtSplattingKernels = KernelList<
    RtCompose,
    RtComposeVjp,
    RtSpecular,
    RtKeptShare,
    RtMaskMoments,
    RtFindInside,
    RtMaskLoss,
    RtChannel>;

}  // namespace glint
