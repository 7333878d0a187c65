// SPDX-License-Identifier: MIT
// What the losses with priors share over an image: sums in a fixed order, so that the number of
// threads does not matter; edge-aware smoothness of a map; the check that images fit together.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "glint/core/error.h"
#include "glint/core/image.h"
#include "glint/core/parallel.h"
#include "glint/train/pixel_losses.h"

namespace glint {

// Sum of term(x, y), a number or a struct with +=, over all pixels: along rows, then over rows.
// Terms may write to places of their own pixel.
template <class F>
auto sum_over_pixels(ImageSize size, F&& term) {
  using Sum = decltype(term(0, 0));
  constexpr std::size_t kRowGrain = 8;
  std::vector<Sum> rows(size.height);
  parallel_for(size.height, kRowGrain, [&](std::size_t row) {
    Sum sum{};
    for (int x = 0; x < size.width; ++x) sum += term(x, static_cast<int>(row));
    rows[row] = sum;
  });
  Sum total{};
  for (const Sum& row : rows) total += row;
  return total;
}

// Of a [H][W][3] image.
template <class T, class S>
Vec3<T> load3(const BasicImage<S>& image, int x, int y) {
  const S* p = image.pixel(x, y);
  return {static_cast<T>(p[0]), static_cast<T>(p[1]), static_cast<T>(p[2])};
}
template <class T>
void store3(BasicImage<T>& image, int x, int y, Vec3<T> v) {
  T* p = image.pixel(x, y);
  p[0] = v.x, p[1] = v.y, p[2] = v.z;
}

// Throws unless the image has the map's size and as many channels as expected.
inline void check_fits(
    std::string_view name, ImageView image, ImageSize expected, int expected_channels
) {
  GLINT_CHECK(
      image.size() == expected && image.channels == expected_channels,
      kBadReference,
      "{}: {}x{} pixels with {} channels found, {}x{} with {} expected, as the rendered map; "
      "resize it to its view's image",
      name,
      image.width,
      image.height,
      image.channels,
      expected.width,
      expected.height,
      expected_channels
  );
}

// One pixel's part in the sum over neighbours p, p + e (e = x, y) of
// |v(p + e) - v(p)|_1 edge_weight(I(p), I(p + e)).
template <int kChannels, class T>
struct SmoothnessAt {
  double loss = 0;          // of the pixel's two forward differences
  T gradient[kChannels]{};  // of the whole sum with respect to v at the pixel
};
// values: v [H][W][kChannels]; guide: I [H][W][3], values in [0, 1]. Differences with a pixel where
// exists(v of the pixel) is false do not count.
template <int kChannels, class T, class Exists>
SmoothnessAt<kChannels, T> edge_aware_smoothness_at(
    const BasicImage<T>& values, const Image& guide, T sharpness, const Exists& exists, int x, int y
) {
  SmoothnessAt<kChannels, T> result;
  const T* here = values.pixel(x, y);
  if (!exists(here)) return result;
  const Vec3<T> color = load3<T>(guide, x, y);
  const auto add_difference = [&](int nx, int ny, bool is_forward) {
    if (nx < 0 || ny < 0 || nx >= values.width() || ny >= values.height()) return;
    const T* there = values.pixel(nx, ny);
    if (!exists(there)) return;
    const T weight = edge_weight(color, load3<T>(guide, nx, ny), sharpness);
    T distance = 0;
    for (int c = 0; c < kChannels; ++c) {
      result.gradient[c] += weight * sign_of(here[c] - there[c]);
      distance += abs_of(here[c] - there[c]);
    }
    if (is_forward) result.loss += static_cast<double>(weight * distance);
  };
  add_difference(x + 1, y, true);
  add_difference(x, y + 1, true);
  add_difference(x - 1, y, false);
  add_difference(x, y - 1, false);
  return result;
}

}  // namespace glint
