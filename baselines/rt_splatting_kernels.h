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
  Vec3<T> specular;   // raw: e^min(x, 5) / 2 is the light
  T attenuation;      // raw: its sigmoid
  T coverage = T(1);  // alpha of the surface pass, a constant: where nothing is, nothing is darker
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

// a [t Tran + (1 - t) Scat] + r spec, a = 1 - (1 - sigmoid(attenuation)) coverage.
template <class T>
GLINT_HD T rt_attenuation(const RtPixel<T>& p) {
  return T(1) - (T(1) - sigmoid(p.attenuation)) * p.coverage;
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
// kept: share of the gradient that the transmitted part a t Tran lets through, a channel each. No
// gradient of the coverage.
template <class T>
GLINT_HD RtPixel<T> rt_color_vjp(const RtPixel<T>& p, RtStage stage, Vec3<T> g, Vec3<T> kept) {
  RtPixel<T> result{};
  if (stage == RtStage::kTransmission) {
    result.transmission = g;
    return result;
  }
  const bool all = stage == RtStage::kAll;
  const T a = all ? rt_attenuation(p) : T(1);
  const Vec3<T> through = hadamard(kept, g);
  result.transmission = a * p.transmissivity * through;
  result.scattered = a * (T(1) - p.transmissivity) * g;
  result.transmissivity = a * (dot(through, p.transmission) - dot(g, p.scattered));
  if (!all) return result;
  const Vec3<T> light = rt_specular(p.specular);
  result.reflectance = dot(g, light);
  result.specular = rt_specular_vjp(p.specular, light, p.reflectance * g);
  const T dL_da = p.transmissivity * dot(through, p.transmission) +
                  (T(1) - p.transmissivity) * dot(g, p.scattered);
  result.attenuation = sigmoid_vjp(sigmoid(p.attenuation), p.coverage * dL_da);
  return result;
}

// Where the surface pass's features have them, behind the colour.
inline constexpr int kRtOpacity = 3, kRtTransmissivity = 4, kRtReflectance = 5, kRtRoughness = 6,
                     kRtFeature = 7, kRtChannels = 11;

// Surface features are null, and the network's outputs and directions, in stages without them.
struct RtPixels {
  RtStage stage;
  const float* transmission;          // [pixels][3]
  const float *surface, *coverage;    // [pixels][kRtChannels], [pixels]: alpha
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
    p.coverage = coverage[i];
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
  const float* kept;  // [pixels][3] share of the transmitted part's gradient; null: all
  float* dL_dtransmission;
  float *dL_dsurface, *dL_doutputs;  // the first is added to; null in stages without them

  GLINT_HD void operator()(std::size_t i) const {
    const Vec3f share = kept == nullptr ? Vec3f{1, 1, 1} : get3(kept, i);
    const RtPixel<float> g =
        rt_color_vjp(pixels.at(i), pixels.stage_at(i), get3(dL_dimage, i), share);
    put3(dL_dtransmission, i, g.transmission);
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

// Specular light of a pixel, alone and as its reflectance lets it be seen.
struct RtSpecular {
  RtPixels pixels;
  float *light, *seen;  // [pixels][3]
  GLINT_HD void operator()(std::size_t i) const {
    const bool shaded = pixels.stage_at(i) == RtStage::kAll;
    const RtPixel<float> p = shaded ? pixels.at(i) : RtPixel<float>{};
    const Vec3f spec = shaded ? rt_specular(p.specular) : Vec3f{};
    put3(light, i, spec);
    put3(seen, i, p.reflectance * spec);
  }
};
// e^(-4 std) of r spec in windows of 3x3 pixels, channel by channel. Pixels weigh 1 - o, so what is
// opaque does not count: std^2 = (sum w x^2 - (sum w x)^2 / sum w) / 9. Mirrored at the border.
struct RtKeptShare {
  ImageView seen;        // r spec
  const float* surface;  // [pixels][kRtChannels]
  float* kept;           // [pixels][3]

  GLINT_HD static int mirrored(int at, int count) {
    if (at < 0) at = -at;
    if (at >= count) at = 2 * count - 2 - at;
    return at < 0 ? 0 : at;  // of one pixel, that
  }
  GLINT_HD float weight(int x, int y) const {
    const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(seen.width) +
                       static_cast<std::size_t>(x);
    return 1 - surface[pixel * static_cast<std::size_t>(kRtChannels) + kRtOpacity];
  }
  GLINT_HD void operator()(std::size_t i) const {
    const auto width = static_cast<std::size_t>(seen.width);
    const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
    const float* here = seen.pixel(x, y);  // relative to it: less cancellation
    float weights = 0;
    Vec3f sum{}, squares{};
    for (int v = y - 1; v <= y + 1; ++v)
      for (int u = x - 1; u <= x + 1; ++u) {
        const int column = mirrored(u, seen.width), row = mirrored(v, seen.height);
        const float w = weight(column, row);
        const Vec3f d = get3(seen.pixel(column, row), 0) - get3(here, 0);
        weights += w;
        sum += w * d;
        squares += w * hadamard(d, d);
      }
    for (int c = 0; c < 3; ++c) {
      const float variance = (squares[c] - sum[c] * sum[c] / max_of(weights, 1e-12f)) / 9;
      kept[3 * i + static_cast<std::size_t>(c)] = exp_fast(-4 * sqrt_of(max_of(variance, 0.0f)));
    }
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
  // Sum of squared distances from the mean: t's, and the mean of those of Scat's channels.
  double scatter() const {
    double total = 0;
    for (int k = 0; k < 4; ++k)
      if (count > 0) total += (k < 3 ? 1.0 / 3 : 1.0) * (squares[k] - sum[k] * mean(k));
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

// What the losses by mask need of a view: means inside it, one over the pixels outside.
struct RtInside {
  float mean[4], per_outside;
};
struct RtFindInside {
  const RtMoments* moments;
  double pixels;
  RtInside* inside;
  GLINT_HD void operator()(std::size_t) const {
    for (int k = 0; k < 4; ++k) inside->mean[k] = static_cast<float>(moments->mean(k));
    inside->per_outside = static_cast<float>(1 / max_of(pixels - moments->count, 1.0));
  }
};

// BCE(1 - opacity, mask), a mean over all pixels, and BCE(t, 0), one over those outside the mask;
// the gradient of both and of RtMoments::scatter().
struct RtMaskLoss {
  ImageView surface, mask;
  const RtInside* inside_mask;
  float weight_opacity;  // over the number of pixels
  float weight_outside, weight_scatter;
  ImageRef dL_dsurface;  // added to

  GLINT_HD double operator()(int x, int y) const {
    const float* s = surface.pixel(x, y);
    float* g = dL_dsurface.pixel(x, y);
    const bool inside = mask.at(x, y) > 0.5f;
    const float target = inside ? 1.0f : 0.0f, through = 1 - s[kRtOpacity];
    float dL_dthrough = 0;
    binary_cross_entropy_vjp(through, target, weight_opacity, dL_dthrough);
    g[kRtOpacity] -= dL_dthrough;
    const double loss = static_cast<double>(weight_opacity * binary_cross_entropy(through, target));
    return loss + (inside ? gather_inside(s, g) : oppose_outside(s, g));
  }

 private:
  GLINT_HD double gather_inside(const float* s, float* g) const {
    for (int k = 0; k < 4; ++k)
      g[k < 3 ? k : kRtTransmissivity] +=
          (k < 3 ? 2.0f / 3 : 2.0f) * weight_scatter * (rt_varying(s, k) - inside_mask->mean[k]);
    return 0;  // RtMoments knows it
  }
  GLINT_HD double oppose_outside(const float* s, float* g) const {
    const float weight = weight_outside * inside_mask->per_outside;
    binary_cross_entropy_vjp(s[kRtTransmissivity], 0.0f, weight, g[kRtTransmissivity]);
    return static_cast<double>(weight * binary_cross_entropy(s[kRtTransmissivity], 0.0f));
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
