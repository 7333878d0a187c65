// SPDX-License-Identifier: MIT
// One channel of an image between its pixel centres.
#pragma once

#include "glint/core/image.h"
#include "glint/core/vec.h"

namespace glint {

// The four pixels around an image point, and their weights.
template <class T>
struct BilinearCell {
  bool inside = false;  // all four are in the image
  int x = 0, y = 0;     // the upper left one
  T right = 0, down = 0;

  // In the order (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1).
  GLINT_HD T weight(int corner) const {
    return (corner % 2 == 0 ? T(1) - right : right) * (corner < 2 ? T(1) - down : down);
  }
};

template <class T>
GLINT_HD BilinearCell<T> bilinear_cell(ImageSize size, Vec2<T> point) {
  const T x = point.x - T(0.5), y = point.y - T(0.5);
  // Not "x < 0": a NaN is outside, too.
  if (!(x >= T(0) && y >= T(0) && x < T(size.width - 1) && y < T(size.height - 1))) return {};
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  return {true, left, top, x - T(left), y - T(top)};
}

template <class T>
struct BilinearSample {
  T value;
  Vec2<T> slope;  // d value / d point
};
// Of a cell inside; channel c of the image.
template <class T, class S>
GLINT_HD BilinearSample<T> bilinear(
    const BasicImageView<S>& image, const BilinearCell<T>& cell, int c = 0
) {
  const T a = T(image.at(cell.x, cell.y, c)), b = T(image.at(cell.x + 1, cell.y, c));
  const T e = T(image.at(cell.x, cell.y + 1, c)), f = T(image.at(cell.x + 1, cell.y + 1, c));
  const T top = a + cell.right * (b - a), bottom = e + cell.right * (f - e);
  const T dx = (b - a) + cell.down * ((f - e) - (b - a));
  return {top + cell.down * (bottom - top), {dx, bottom - top}};
}

}  // namespace glint
