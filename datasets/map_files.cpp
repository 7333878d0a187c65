// SPDX-License-Identifier: MIT
#include "datasets/map_files.h"

#include <algorithm>
#include <cmath>

#include "glint/core/error.h"
#include "glint/scene/image_files.h"

namespace glint {

Image encode_depth(ImageView depth) {
  Image encoded(depth.width, depth.height, 3);
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      const float value = std::clamp(depth.at(x, y), 0.0f, 1.0f);
      const float high = std::floor(value * 255) / 255;
      encoded.at(x, y, 0) = high;
      encoded.at(x, y, 1) = std::min(1.0f, (value - high) * 256);
    }
  return encoded;
}

Image encode_normal(ImageView normal) {
  Image encoded(normal.width, normal.height, 3);
  for (std::size_t i = 0; i < encoded.values().size(); ++i)
    encoded.values()[i] = 0.5f * normal.data[i] + 0.5f;
  return encoded;
}

void write_prior(const fs::path& path, MapKind kind, const Image& map) {
  if (kind == MapKind::kNormal) return write_png(path, encode_normal(map));
  write_png(path, kind == MapKind::kDepth ? encode_depth(map) : map);
}

void write_true_map(const fs::path& path, MapKind kind, const Image& map) {
  if (kind == MapKind::kMask) return write_png(path, map);
  write_exr(path, map, kind == MapKind::kNormal);
}

std::size_t write_depth_millimetres(const fs::path& path, ImageView depth) {
  Image steps(depth.width, depth.height, 1);  // of 1 / 65535
  std::size_t num_beyond = 0;
  for (std::size_t i = 0; i < steps.num_pixels(); ++i) {
    const float millimetres = 1000 * depth.data[i];
    if (millimetres <= kFarthestMillimetres)
      steps.data()[i] = millimetres / kFarthestMillimetres;
    else
      ++num_beyond;
  }
  write_png16(path, steps);
  return num_beyond;
}

void check_finite(const fs::path& path, const Image& map) {
  const auto channels = static_cast<std::size_t>(map.channels());
  for (std::size_t i = 0; i < map.values().size(); ++i) {
    const std::size_t pixel = i / channels;
    GLINT_CHECK(
        std::isfinite(map.values()[i]),
        kBadReference,
        "{}: pixel ({}, {}) is {}; store 0 where nothing is known",
        path.string(),
        pixel % static_cast<std::size_t>(map.width()),
        pixel / static_cast<std::size_t>(map.width()),
        map.values()[i]
    );
  }
}

}  // namespace glint
