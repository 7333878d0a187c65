// SPDX-License-Identifier: MIT
// One pixel on its way to its first surface: the text of every rasteriser backend.
#pragma once

#include "glint/render/first_surface.h"
#include "glint/render/splat_hit.h"

namespace glint {

struct SurfacePixel {
  float x, y, nearest;  // pixel centre; only hits behind this depth count
  float transmittance = 1;
  SurfaceHits hits;

  GLINT_HD SurfacePixel(int column, int row, float nearest_depth)
      : x(static_cast<float>(column) + 0.5f),
        y(static_cast<float>(row) + 0.5f),
        nearest(nearest_depth) {}
  // The next splat of its tile, front to back. False: no further one can count.
  GLINT_HD bool add(const Splat& splat) {
    SplatHit<float> hit;
    const bool counts = composite_splat(splat, splat.map, x, y, nearest, transmittance, hit);
    if (counts && hit.weight > 0) hits.add(hit.depth, hit.weight);
    return transmittance > 0 && hits.count < SurfaceHits::kMax;
  }
};

}  // namespace glint
