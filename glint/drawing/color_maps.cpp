// SPDX-License-Identifier: MIT
#include "glint/drawing/color_maps.h"

#include <algorithm>
#include <cmath>

#include "glint/core/vec.h"

namespace glint {
namespace {

// Between two entries, colours are mixed.
Vec3f table_color(const ColorTable& table, float t) {
  constexpr int kLast = static_cast<int>(std::tuple_size_v<ColorTable>) / 3 - 1;
  const float position = std::clamp(t, 0.0f, 1.0f) * static_cast<float>(kLast);
  const int entry = std::min(static_cast<int>(position), kLast - 1);
  const float f = position - static_cast<float>(entry);
  const auto channel = [&](std::size_t c) {
    const int* at = table.data() + 3 * entry + c;
    return 1e-6f * ((1 - f) * static_cast<float>(at[0]) + f * static_cast<float>(at[3]));
  };
  return {channel(0), channel(1), channel(2)};
}

void set_pixel(Image& image, std::size_t pixel, Vec3f color) {
  float* to = image.data() + 3 * pixel;
  to[0] = color.x, to[1] = color.y, to[2] = color.z;
}

}  // namespace

Image colorize_depth(ImageView depth, float low, float high) {
  Image image(depth.width, depth.height, 3);
  const float range = std::max(high - low, 1e-12f);
  for (std::size_t i = 0; i < depth.num_pixels(); ++i) {
    const float z = depth.data[i * static_cast<std::size_t>(depth.channels)];
    if (std::isfinite(z) && z > 0)
      set_pixel(image, i, table_color(kViridis, 1 - (z - low) / range));
  }
  return image;
}

Image colorize_scalar(ImageView map, float low, float high, ScalarColors colors) {
  const ColorTable& table = colors == ScalarColors::kMagma ? kMagma : kViridis;
  Image image(map.width, map.height, 3, 0.5f);
  const float range = std::max(high - low, 1e-12f);
  for (std::size_t i = 0; i < map.num_pixels(); ++i) {
    const float value = map.data[i * static_cast<std::size_t>(map.channels)];
    if (std::isfinite(value)) set_pixel(image, i, table_color(table, (value - low) / range));
  }
  return image;
}

Image grey_picture(ImageView map) {
  Image image(map.width, map.height, 3);
  for (std::size_t i = 0; i < map.num_pixels(); ++i) {
    const float value =
        std::clamp(map.data[i * static_cast<std::size_t>(map.channels)], 0.0f, 1.0f);
    set_pixel(image, i, {value, value, value});
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
