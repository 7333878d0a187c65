// SPDX-License-Identifier: MIT
// Losses on the transparency map t, pixel by pixel: guidance (transparency_guidance.h) and prior
// (transparency_prior.h).
#pragma once

#include "glint/core/kernel.h"
#include "glint/render/glass_kernels.h"
#include "glint/render/map_kernels.h"
#include "glint/train/pixel_access.h"

namespace glint {

// What the labels of guidance are made from (TransparencyCues) and where they go, 1 or 0.
struct LabelMaps {
  ImageView interface_depth, transmission_depth, albedo, basecolor;
  ImageRef transparent, opaque;

  GLINT_HD static float mean_rgb(const ImageView& image, int x, int y) {
    const float* p = image.pixel(x, y);
    return (p[0] + p[1] + p[2]) / 3;
  }
  GLINT_HD void put(int x, int y, bool is_transparent, bool is_opaque) const {
    transparent.at(x, y) = is_transparent ? 1.0f : 0.0f;
    opaque.at(x, y) = is_opaque ? 1.0f : 0.0f;
  }
};

// 1 where kL1 may look at depths.
struct MarkLowAlbedo {
  ImageView albedo;
  float low_albedo;
  ImageRef marks;

  GLINT_HD void operator()(std::size_t i) const {
    const int x = static_cast<int>(i) % marks.width, y = static_cast<int>(i) / marks.width;
    marks.at(x, y) = LabelMaps::mean_rgb(albedo, x, y) < low_albedo ? 1.0f : 0.0f;
  }
};

struct LabelL1 {
  LabelMaps maps;
  float depth_threshold, low_albedo;

  GLINT_HD void operator()(std::size_t i) const {
    const int width = maps.transparent.width;
    const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
    const float z = maps.interface_depth.at(x, y), behind = maps.transmission_depth.at(x, y);
    const bool apart = z > 0 && behind > 0 && abs_of(z - behind) > depth_threshold;
    const bool transparent = apart && LabelMaps::mean_rgb(maps.albedo, x, y) < low_albedo;
    maps.put(x, y, transparent, !transparent);
  }
};

struct LabelBce {
  LabelMaps maps;
  float depth_threshold, low_albedo, high_albedo, bright_basecolor;

  GLINT_HD void operator()(std::size_t i) const {
    const int width = maps.transparent.width;
    const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
    const float z = maps.interface_depth.at(x, y), behind = maps.transmission_depth.at(x, y);
    const float albedo = LabelMaps::mean_rgb(maps.albedo, x, y);
    const bool is_low = albedo < low_albedo, is_high = high_albedo < albedo;
    const bool is_bright = LabelMaps::mean_rgb(maps.basecolor, x, y) > bright_basecolor;
    const bool is_behind = behind > z + depth_threshold;
    maps.put(
        x,
        y,
        is_low && is_bright && z > 0 && behind > 0 && is_behind,
        is_high || (is_low && !is_bright) || !is_behind
    );
  }
};

// Minimum over the 3x3 neighbours inside the image, times a weight that falls from 1 at 70 degrees
// between ray and normal to 0 at 80.
struct ErodeAndWeigh {
  static constexpr float kCos70 = 0.342020143f, kCos80 = 0.173648178f;
  ImageView mask, cosine;  // cosine may be empty: 1
  ImageRef out;

  GLINT_HD void operator()(std::size_t i) const {
    const int x = static_cast<int>(i) % mask.width, y = static_cast<int>(i) / mask.width;
    const float c = cosine.num_pixels() == 0 ? 1.0f : cosine.at(x, y);
    const float weight = min_of(max_of((c - kCos80) / (kCos70 - kCos80), 0.0f), 1.0f);
    float least = mask.at(x, y);
    for (int ny = y - 1; ny <= y + 1; ++ny)
      for (int nx = x - 1; nx <= x + 1; ++nx)
        if (nx >= 0 && ny >= 0 && nx < mask.width && ny < mask.height)
          least = min_of(least, mask.at(nx, ny));
    out.at(x, y) = weight * least;
  }
};

template <class T>
struct GuideL1 {
  BasicImageView<T> t;
  ImageView target, opaque;  // opaque may be empty; neither: the pixel does not count
  T scale, transparent_weight;
  BasicImageRef<T> dL_dt;

  GLINT_HD double operator()(int x, int y) const {
    const bool counts = opaque.empty() || target.at(x, y) + opaque.at(x, y) > 0;
    if (!counts) return 0;
    const T difference = t.at(x, y) - static_cast<T>(target.at(x, y));
    const T weight = target.at(x, y) > 0 ? transparent_weight : T(1);
    dL_dt.at(x, y) += scale * weight * sign_of(difference);
    return static_cast<double>(weight * abs_of(difference));
  }
};

struct ViewingCosine {
  PixelRays rays;
  const float* normal;  // [H][W][3] composited, camera space
  float* cosine;
  GLINT_HD void operator()(std::size_t i) const {
    cosine[i] = abs_of(dot(unit_normal(map3(normal, i)), rays.at(i).unit()));
  }
};

template <class T>
struct ReadTransparency {
  BasicImageView<T> t;
  GLINT_HD bool operator()(int x, int y, T* out) const {
    out[0] = t.at(x, y);
    return true;
  }
};
template <class T>
struct TransparencyPriorAt {
  Smoothness<1, T, ReadTransparency<T>> smoothness;
  T w_entropy, w_sparsity, w_smoothness, scale;
  BasicImageRef<T> dL_dt;

  GLINT_HD double operator()(int x, int y) const {
    const T t = smoothness.read.t.at(x, y);
    const auto smooth = smoothness.at(x, y);
    T& gradient = dL_dt.at(x, y);
    binary_entropy_vjp(t, scale * w_entropy, gradient);
    gradient += scale * (w_sparsity * sign_of(t) + w_smoothness * smooth.gradient[0]);
    return static_cast<double>(w_entropy * binary_entropy(t) + w_sparsity * abs_of(t)) +
           static_cast<double>(w_smoothness) * smooth.loss;
  }
};

using TransparencyKernels = KernelList<
    MarkLowAlbedo,
    LabelL1,
    LabelBce,
    ErodeAndWeigh,
    ViewingCosine,
    GuideL1<float>,
    TransparencyPriorAt<float>>;

}  // namespace glint
