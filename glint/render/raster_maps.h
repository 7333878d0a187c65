// SPDX-License-Identifier: MIT
// The maps of a rasterisation as one list, from which outputs, their gradients, a pixel's sums,
// memory, loads and stores are made on every backend.
//
// A new map sum w v, where v is the same all over a surfel (a plane's distance, say), takes:
//   1. here: a member of RasterMaps and its line in for_each_map();
//   2. project.h: v in ProjectedSurfel, and its vjp;
//   3. splat.h: the copy of v in Splat, its slot, its line in for_each_attribute().
// One that differs from hit to hit takes 1. and its two lines in pixel_pass.h, forward and back.
#pragma once

#include <cstdint>

#include "glint/core/image.h"

namespace glint {

// Map<channels>: what holds one of them, an image or a pixel's numbers. kFeatures: channels of
// `features`; 0: known at run time only.
template <template <int> class Map, int kFeatures = 0>
struct RasterMaps {
  Map<kFeatures> features;  // [H][W][C] sum w f; no background is added
  Map<1> alpha;             // [H][W][1] sum w = 1 - transmittance
  // The next three, of the surface: empty where it was not asked for.
  Map<1> depth_sum;  // [H][W][1] sum w z; expected depth = depth_sum / alpha
  Map<1>
      depth_median;   // [H][W][1] z of the last contributor met while transmittance > 0.5; 0: none
  Map<3> normal;      // [H][W][3] sum w n in camera space, each n facing the camera; not unit
  Map<1> distortion;  // [H][W][1] sum_ij w_i w_j (m_i - m_j)^2, j < i; empty unless asked for
  // [H][W][1] sum w d with d = |n.m| of the surfel's plane, its distance from the camera centre,
  // metres; empty unless asked for.
  Map<1> plane_distance;
};

// Features of passes that may do without a surface, and then have code of their own.
inline constexpr int kColorChannels = 3;

// Which maps and sums a call has.
struct MapChannels {
  int features = 3;
  bool distortion = false;
  bool plane_distance = false;
  bool statistics = false;  // of density control
  bool surface = true;      // depth_sum, depth_median, normal
  // Feature channels, a bit each, whose gradient ends at the features: where surfels are and how
  // opaque is not moved by it. Not in calls of colour alone.
  std::uint32_t detached = 0;

  // Whether surfels get sums back that most calls have no use for.
  GLINT_HD constexpr bool has_extras() const { return plane_distance || statistics; }
  GLINT_HD constexpr bool is_detached(int feature) const { return (detached >> feature & 1u) != 0; }
};

// f(name, channels, map of each argument) for every map; 0 channels: the call has it not.
template <class F, class... Maps>
GLINT_HD void for_each_map(MapChannels has, F&& f, Maps&... maps) {
  f("features", has.features, maps.features...);
  f("alpha", 1, maps.alpha...);
  f("depth_sum", has.surface ? 1 : 0, maps.depth_sum...);
  f("depth_median", has.surface ? 1 : 0, maps.depth_median...);
  f("normal", has.surface ? 3 : 0, maps.normal...);
  f("distortion", has.distortion ? 1 : 0, maps.distortion...);
  f("plane_distance", has.plane_distance ? 1 : 0, maps.plane_distance...);
}

// What the way back needs of a pixel besides its maps.
template <template <int> class Map>
struct KeptMaps {
  Map<1> transmittance;  // behind all hits
  // Of the distortion: depth of the first hit; sum w m, sum w m^2 relative to it.
  Map<1> first_depth, moment1, moment2;
};

// f(channels, value where nothing was hit, map of each argument).
template <class F, class... Maps>
GLINT_HD void for_each_kept_map(MapChannels has, F&& f, Maps&... maps) {
  const int of_distortion = has.distortion ? 1 : 0;
  f(1, 0.0f, maps.transmittance...);
  f(of_distortion, 1.0f, maps.first_depth...);
  f(of_distortion, 0.0f, maps.moment1...);
  f(of_distortion, 0.0f, maps.moment2...);
}

// Holders of a map: an image; borrowed memory, null where there is none.
template <int>
using ImageMap = Image;
template <int>
using PointerMap = float*;

}  // namespace glint
