// SPDX-License-Identifier: MIT
// Uniform values.
#pragma once

#include "glint/core/image.h"
#include "glint/core/rng.h"
#include "glint/scene/surfels.h"

namespace glint::test {

template <class T = float>
BasicImage<T> random_map(Rng& rng, ImageSize size, int channels, float low, float high) {
  BasicImage<T> map(size.width, size.height, channels);
  for (T& value : map.values()) value = static_cast<T>(rng.uniform(low, high));
  return map;
}
template <class T = float>
BasicImage<T> random_map(ImageSize size, int channels, float low, float high, std::uint64_t seed) {
  Rng rng(seed);
  return random_map<T>(rng, size, channels, low, high);
}

inline FloatArray random_array(
    std::size_t count, std::uint64_t seed, float low = -1, float high = 1
) {
  Rng rng(seed);
  FloatArray array(count);
  for (float& value : array) value = rng.uniform(low, high);
  return array;
}

// Raw parameters within +-largest.
inline SurfelCloud random_cloud(
    std::size_t count, std::vector<std::string> extra_names, float largest = 1
) {
  SurfelCloud cloud;
  cloud.extra_names = std::move(extra_names);
  cloud.resize(count);
  Rng rng(3);
  cloud.for_each_array([&](const char*, FloatArray& array, std::size_t) {
    for (float& value : array) value = rng.uniform(-largest, largest);
  });
  return cloud;
}

// Within a metre or so of the origin, of centimetres to decimetres, in all colours.
inline SurfelCloud ball_of_surfels(
    std::size_t count, std::uint64_t seed, std::vector<std::string> extra_names = {}
) {
  SurfelCloud cloud;
  cloud.extra_names = std::move(extra_names);
  cloud.resize(count);
  Rng rng(seed);
  for (float& v : cloud.means) v = rng.uniform(-1.2f, 1.2f);
  for (float& v : cloud.log_scales) v = rng.uniform(-3.0f, -1.0f);
  for (float& v : cloud.rotations) v = rng.normal();
  for (float& v : cloud.opacity_logits) v = rng.uniform(-2.0f, 3.0f);
  for (float& v : cloud.sh_dc) v = rng.normal();
  for (float& v : cloud.sh_rest) v = 0.1f * rng.normal();
  for (float& v : cloud.extra_logits) v = rng.normal();
  return cloud;
}

}  // namespace glint::test
