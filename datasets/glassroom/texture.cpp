// SPDX-License-Identifier: MIT
#include "datasets/glassroom/texture.h"

#include <algorithm>
#include <cmath>

namespace glint::path_tracing {

namespace {

// The two texels around a coordinate and the weight of the second.
struct Taps {
  int first, second;
  float weight;
};

Taps repeat_taps(float coordinate, int size) {
  // Wrapped before scaling: large coordinates keep their fraction.
  const float x = (coordinate - std::floor(coordinate)) * static_cast<float>(size) - 0.5f;
  const float cell = std::floor(x);
  const int first = std::clamp(static_cast<int>(cell), -1, size - 1);
  return {first < 0 ? size - 1 : first, first + 1 < size ? first + 1 : 0, x - cell};
}

Vec3f texel(ImageView texture, int x, int y) {
  const float* value = texture.pixel(x, y);
  return {value[0], value[1], value[2]};
}

Vec3f mix(Vec3f a, Vec3f b, float t) { return (1 - t) * a + t * b; }

}  // namespace

Vec3f sample_texture(ImageView texture, Vec2f uv) {
  const Taps x = repeat_taps(uv.x, texture.width), y = repeat_taps(uv.y, texture.height);
  const Vec3f top =
      mix(texel(texture, x.first, y.first), texel(texture, x.second, y.first), x.weight);
  const Vec3f bottom =
      mix(texel(texture, x.first, y.second), texel(texture, x.second, y.second), x.weight);
  return mix(top, bottom, y.weight);
}

void prefetch_texture(ImageView texture, Vec2f uv) {
  const Taps x = repeat_taps(uv.x, texture.width), y = repeat_taps(uv.y, texture.height);
  for (const int row : {y.first, y.second})
    for (const int column : {x.first, x.second}) __builtin_prefetch(texture.pixel(column, row));
}

}  // namespace glint::path_tracing
