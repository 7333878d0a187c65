// SPDX-License-Identifier: MIT
// The true first surface in the place of a rasterised one, for methods that are no rivals: depth,
// normal and t (1 on glass) are given, colour and s stay those of the surfels.
#pragma once

#include "glint/render/rasterize.h"
#include "glint/scene/maps.h"

namespace glint {

class GivenSurface {
 public:
  // Whether the maps have what it takes.
  static bool fits(const MapSet& truth) {
    return truth.has("depth") && truth.has("normal") && truth.has("glass");
  }
  // What `interface` would be, had it the true surface; valid until the next call. transparency:
  // the feature that is t. Errors (kBadReference): maps of another size.
  const RasterOutput& put(const RasterOutput& interface, const MapSet& truth, int transparency);
  // Gradient of what put() returned, zero at first, and its way back to the features.
  RasterOutputGradient& gradient();
  void put_vjp(RasterOutputGradient& dL_dinterface);

 private:
  int transparency_ = 0;
  RasterOutput surface_;
  RasterOutputGradient gradient_;
};

}  // namespace glint
