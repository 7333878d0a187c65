// SPDX-License-Identifier: MIT
// Depth of the first surface along a ray that also sees what lies behind it, for output only: it
// has no gradient [Li25, TSGS]. Rasterizer::first_surface() makes the map.
//
// A pixel outside the mask takes the depth of the last contributor met while T > 0.5
// (depth_median). Inside, its hits (depth, weight) are sorted by depth; candidates reach from the
// first up to the one whose cumulative weight exceeds `weight_window`, which counts, too. A window
// of `window` metres begins at each candidate in turn; the heaviest one's weighted mean depth is
// the surface, the nearest one's where they weigh the same.
#pragma once

#include "glint/core/real.h"

namespace glint {

struct FirstSurfaceSettings {
  float window = 0.03f;             // metres; published in scene units: scale it by the scene
  float weight_window = 0.1f;       // cumulative weight that ends the candidates
  float max_transmittance = 0.98f;  // where more light is left behind all hits there is no surface
};

// Hits of one pixel in order of depth, those of equal depth as they came. Of more than kMax the
// first to be added are kept.
struct SurfaceHits {
  static constexpr int kMax = 300;
  float depths[kMax];   // metres
  float weights[kMax];  // > 0
  int count = 0;

  GLINT_HD void add(float depth, float weight) {
    if (count == kMax) return;
    int place = count++;
    for (; place > 0 && depths[place - 1] > depth; --place) {
      depths[place] = depths[place - 1];
      weights[place] = weights[place - 1];
    }
    depths[place] = depth;
    weights[place] = weight;
  }
};

// One past the last candidate.
GLINT_HD int surface_candidates(const SurfaceHits& hits, float weight_window) {
  float sum = 0;
  for (int i = 0; i < hits.count; ++i)
    if ((sum += hits.weights[i]) > weight_window) return i + 1;
  return hits.count;
}

// 0: no hits.
GLINT_HD float first_surface_depth(const SurfaceHits& hits, const FirstSurfaceSettings& settings) {
  const int count = surface_candidates(hits, settings.weight_window);
  float heaviest = 0, depth = 0;
  for (int first = 0; first < count; ++first) {
    const float end = hits.depths[first] + settings.window;
    float weight = 0, offset = 0;  // sum of w and of w (z - z of the first)
    for (int i = first; i < count && hits.depths[i] <= end; ++i) {
      weight += hits.weights[i];
      offset += hits.weights[i] * (hits.depths[i] - hits.depths[first]);
    }
    if (weight <= heaviest) continue;
    heaviest = weight;
    depth = hits.depths[first] + offset / weight;
  }
  return depth;
}

}  // namespace glint
