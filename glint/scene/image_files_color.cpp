// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include "glint/core/vec.h"
#include "glint/scene/image_files.h"

namespace glint {
namespace {

constexpr std::size_t kStops = 5;
using Ramp = std::array<Vec3f, kStops>;

// Five colours each of the viridis and magma maps (CC0), dark to light.
constexpr Ramp kViridis{
    {{0.267f, 0.005f, 0.329f},
     {0.230f, 0.322f, 0.546f},
     {0.128f, 0.567f, 0.551f},
     {0.369f, 0.789f, 0.383f},
     {0.993f, 0.906f, 0.144f}}};
constexpr Ramp kMagma{
    {{0.001f, 0.000f, 0.014f},
     {0.317f, 0.072f, 0.485f},
     {0.716f, 0.215f, 0.475f},
     {0.987f, 0.536f, 0.382f},
     {0.987f, 0.991f, 0.750f}}};

Vec3f ramp_color(const Ramp& ramp, float t) {
  constexpr int kLast = static_cast<int>(kStops) - 1;
  const float position = std::clamp(t, 0.0f, 1.0f) * static_cast<float>(kLast);
  const int i = std::min(static_cast<int>(position), kLast - 1);
  const float f = position - static_cast<float>(i);
  const auto at = static_cast<std::size_t>(i);
  return (1 - f) * ramp[at] + f * ramp[at + 1];
}

void set_pixel(Image& image, std::size_t pixel, Vec3f color) {
  float* to = image.data() + 3 * pixel;
  to[0] = color.x, to[1] = color.y, to[2] = color.z;
}

}  // namespace

float srgb_encode(float linear) {
  if (!(linear > 0)) return 0;
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

float srgb_decode(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

Image colorize_depth(ImageView depth, float low, float high) {
  Image image(depth.width, depth.height, 3);
  const float range = std::max(high - low, 1e-12f);
  for (std::size_t i = 0; i < depth.num_pixels(); ++i) {
    const float z = depth.data[i * static_cast<std::size_t>(depth.channels)];
    if (std::isfinite(z) && z > 0) set_pixel(image, i, ramp_color(kViridis, 1 - (z - low) / range));
  }
  return image;
}

Image colorize_scalar(ImageView map, float low, float high, ScalarColors colors) {
  const Ramp& ramp = colors == ScalarColors::kMagma ? kMagma : kViridis;
  Image image(map.width, map.height, 3, 0.5f);
  const float range = std::max(high - low, 1e-12f);
  for (std::size_t i = 0; i < map.num_pixels(); ++i) {
    const float value = map.data[i * static_cast<std::size_t>(map.channels)];
    if (std::isfinite(value)) set_pixel(image, i, ramp_color(ramp, (value - low) / range));
  }
  return image;
}

Image colorize_normal(ImageView normal) {
  Image image(normal.width, normal.height, 3);
  for (std::size_t i = 0; i < normal.num_pixels(); ++i) {
    const float* n = normal.data + 3 * i;
    if (n[0] == 0 && n[1] == 0 && n[2] == 0) continue;  // missing: black
    set_pixel(image, i, {0.5f + 0.5f * n[0], 0.5f - 0.5f * n[1], 0.5f - 0.5f * n[2]});
  }
  return image;
}

}  // namespace glint
