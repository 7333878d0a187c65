// SPDX-License-Identifier: MIT
// The images and maps of scripts/make_conformance.py, by the same formulas on integers.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "glint/core/image.h"

namespace glint::golden {

inline std::uint32_t hashed(int x, int y, int c, int salt) {
  std::uint32_t v =
      static_cast<std::uint32_t>(x) * 374761393u + static_cast<std::uint32_t>(y) * 668265263u +
      static_cast<std::uint32_t>(c) * 40503u + static_cast<std::uint32_t>(salt) * 974711u;
  v = (v ^ (v >> 13)) * 1274126177u;
  return v ^ (v >> 16);
}
// hashed() in 0 ... n - 1.
inline int below(int n, int x, int y, int c, int salt) {
  return static_cast<int>(hashed(x, y, c, salt) % static_cast<std::uint32_t>(n));
}

inline int triangle_wave(int t) { return t % 256 < 128 ? 2 * (t % 256) : 510 - 2 * (t % 256); }

inline int reference_byte(int x, int y, int c) {
  const int wave = triangle_wave(3 * x + 2 * y + 30 * c);
  return std::clamp(wave + below(41, x, y, c, 1) - 20, 0, 255);
}
inline int prediction_byte(int x, int y, int c) {
  const int wave = (3 * triangle_wave(3 * x + 2 * y + 30 * c + 5) + 64) / 4;
  return std::clamp(wave + below(61, x, y, c, 2) - 30, 0, 255);
}

template <class F>
Image make_image(int width, int height, int channels, F&& value) {
  Image image(width, height, channels);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < channels; ++c) image.at(x, y, c) = value(x, y, c);
  return image;
}

inline Image reference_image(int width, int height, int channels) {
  return make_image(width, height, channels, [](int x, int y, int c) {
    return static_cast<float>(reference_byte(x, y, c)) / 255.0f;
  });
}
inline Image prediction_image(int width, int height, int channels) {
  return make_image(width, height, channels, [](int x, int y, int c) {
    return static_cast<float>(prediction_byte(x, y, c)) / 255.0f;
  });
}
// Float values that leave [0, 1], as renders do.
inline Image rendered_image(int width, int height, int channels) {
  return make_image(width, height, channels, [](int x, int y, int c) {
    return static_cast<float>(prediction_byte(x, y, c) * (1.1 / 255) - 0.03);
  });
}
inline double true_depth(int x, int y) {
  if (below(29, x, y, 0, 4) == 0) return 25;
  if (below(17, x, y, 0, 4) == 0) return 0;
  return (1000 + below(4000, x, y, 0, 4)) / 1000.0;
}
inline double predicted_depth(int x, int y) {
  if (below(13, x, y, 0, 5) == 0) return 0;
  if (below(31, x, y, 0, 5) == 0) return std::numeric_limits<double>::quiet_NaN();
  return true_depth(x, y) * (1 + (below(401, x, y, 0, 5) - 150) / 500.0) + 0.05;
}
inline Image true_depth_map(int width, int height) {
  return make_image(width, height, 1, [](int x, int y, int) {
    return static_cast<float>(true_depth(x, y));
  });
}
inline Image predicted_depth_map(int width, int height) {
  return make_image(width, height, 1, [](int x, int y, int) {
    return static_cast<float>(predicted_depth(x, y));
  });
}

// Before some are shortened or removed.
inline double unit_normal(int x, int y, int c) {
  const double nx = (below(2001, x, y, 0, 6) - 1000) / 1000.0;
  const double ny = (below(2001, x, y, 1, 6) - 1000) / 1000.0;
  const double values[3] = {nx, ny, -1.0};
  return values[c] / std::sqrt(nx * nx + ny * ny + 1.0);
}
inline Image true_normal_map(int width, int height) {
  return make_image(width, height, 3, [](int x, int y, int c) {
    if (below(19, x, y, 0, 7) == 0) return 0.0f;
    const double n = unit_normal(x, y, c);
    return static_cast<float>(below(7, x, y, 0, 7) == 0 ? 0.8 * n : n);
  });
}
inline Image predicted_normal_map(int width, int height) {
  return make_image(width, height, 3, [](int x, int y, int c) {
    if (below(11, x, y, 0, 7) == 0) return 0.0f;
    return static_cast<float>(
        0.5 * (unit_normal(x, y, c) + (below(801, x, y, c, 8) - 400) / 1000.0)
    );
  });
}

}  // namespace glint::golden
