// SPDX-License-Identifier: MIT
// What LPIPS does around its network (lpips.cpp), on either device; element i: a pixel.
#pragma once

#include "glint/core/kernel.h"
#include "glint/core/real.h"
#include "metrics/lpips_formula.h"

namespace glint {

GLINT_HD int column_of(std::size_t i, int width) {
  return static_cast<int>(i % static_cast<std::size_t>(width));
}
GLINT_HD int row_of(std::size_t i, int width) {
  return static_cast<int>(i / static_cast<std::size_t>(width));
}

struct FeedLpips {
  ImageView image;
  LpipsInput inputs[3];
  bool clamp;
  ImageRef to;

  GLINT_HD void operator()(std::size_t i) const {
    const int x = column_of(i, image.width), y = row_of(i, image.width);
    for (int c = 0; c < 3; ++c) {
      const float value = image.at(x, y, c);
      const float fed = clamp ? min_of(max_of(value, 0.0f), 1.0f) : value;
      to.at(x, y, c) = inputs[c].gain * fed + inputs[c].offset;
    }
  }
};

struct KeepFeatures {
  const float* from;
  float* to;
  GLINT_HD void operator()(std::size_t i) const { to[i] = from[i]; }
};

// A tap of two images.
struct LpipsTapPair {
  ImageView a, b;
  const float* lin;
  GLINT_HD double distance(int x, int y) const {
    return lpips_tap<double>(a.pixel(x, y), b.pixel(x, y), lin, a.channels);
  }
};

struct LpipsDistanceAt {
  LpipsTapPair tap;
  GLINT_HD double operator()(int x, int y) const { return tap.distance(x, y); }
};
struct LpipsDistanceMap {
  LpipsTapPair tap;
  double* map;
  GLINT_HD void operator()(std::size_t i) const {
    map[i] = tap.distance(column_of(i, tap.a.width), row_of(i, tap.a.width));
  }
};

// Adds to the gradient of a.
struct LpipsDistanceVjp {
  LpipsTapPair tap;
  double dL_ddistance;
  ImageRef dL_da;
  GLINT_HD void operator()(std::size_t i) const {
    const int x = column_of(i, tap.a.width), y = row_of(i, tap.a.width);
    lpips_tap_vjp(
        tap.a.pixel(x, y),
        tap.b.pixel(x, y),
        tap.lin,
        tap.a.channels,
        dL_ddistance,
        dL_da.pixel(x, y)
    );
  }
};

struct AddFedGradient {
  ImageView dL_dfed;
  LpipsInput inputs[3];
  ImageRef dL_dimage;
  GLINT_HD void operator()(std::size_t i) const {
    const int x = column_of(i, dL_dfed.width), y = row_of(i, dL_dfed.width);
    for (int c = 0; c < 3; ++c) dL_dimage.at(x, y, c) += inputs[c].gain * dL_dfed.at(x, y, c);
  }
};

using LpipsKernels = KernelList<
    FeedLpips,
    KeepFeatures,
    LpipsDistanceAt,
    LpipsDistanceMap,
    LpipsDistanceVjp,
    AddFedGradient>;

}  // namespace glint
