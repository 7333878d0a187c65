// SPDX-License-Identifier: MIT
// How the kernels of losses read and write maps.
#pragma once

#include "glint/core/image.h"
#include "glint/train/pixel_losses.h"

namespace glint {

// Of a [H][W][3] image.
template <class T, class S>
GLINT_HD Vec3<T> load3(const BasicImageView<S>& image, int x, int y) {
  const S* p = image.pixel(x, y);
  return {static_cast<T>(p[0]), static_cast<T>(p[1]), static_cast<T>(p[2])};
}
template <class T>
GLINT_HD void add3(const BasicImageRef<T>& image, int x, int y, Vec3<T> v) {
  T* p = image.pixel(x, y);
  p[0] += v.x;
  p[1] += v.y;
  p[2] += v.z;
}
template <class T>
GLINT_HD void store3(const BasicImageRef<T>& image, int x, int y, Vec3<T> v) {
  T* p = image.pixel(x, y);
  p[0] = v.x;
  p[1] = v.y;
  p[2] = v.z;
}

// One pixel's part in the sum over neighbours p, p + e (e = x, y) of
// |v(p + e) - v(p)|_1 edge_weight(I(p), I(p + e)).
template <int kChannels, class T>
struct SmoothnessAt {
  double loss = 0;          // of the pixel's two forward differences
  T gradient[kChannels]{};  // of the whole sum with respect to v at the pixel
};
// read(x, y, v[kChannels]): the map; false: no value there, and its differences do not count.
// guide: I [H][W][3], values in [0, 1].
template <int kChannels, class T, class Read>
struct Smoothness {
  Read read;
  ImageView guide;
  T sharpness;

  GLINT_HD SmoothnessAt<kChannels, T> at(int x, int y) const {
    SmoothnessAt<kChannels, T> result;
    T here[kChannels];
    if (!read(x, y, here)) return result;
    add_difference(here, x, y, x + 1, y, true, result);
    add_difference(here, x, y, x, y + 1, true, result);
    add_difference(here, x, y, x - 1, y, false, result);
    add_difference(here, x, y, x, y - 1, false, result);
    return result;
  }

 private:
  GLINT_HD void add_difference(
      const T* here,
      int x,
      int y,
      int nx,
      int ny,
      bool is_forward,
      SmoothnessAt<kChannels, T>& result
  ) const {
    T there[kChannels];
    if (nx < 0 || ny < 0 || nx >= guide.width || ny >= guide.height || !read(nx, ny, there)) return;
    const T weight = edge_weight(load3<T>(guide, x, y), load3<T>(guide, nx, ny), sharpness);
    T distance = 0;
    for (int c = 0; c < kChannels; ++c) {
      result.gradient[c] += weight * sign_of(here[c] - there[c]);
      distance += abs_of(here[c] - there[c]);
    }
    if (is_forward) result.loss += static_cast<double>(weight * distance);
  }
};

}  // namespace glint
