// SPDX-License-Identifier: MIT
// The rasteriser forward and backward with all its maps, and results compared byte by byte.
#pragma once

#include <catch2/catch.hpp>
#include <cstring>

#include "glint/render/rasterize.h"
#include "tests/support/random_scene.h"
#include "tests/support/same_bytes.h"

namespace glint::test {

inline constexpr RasterSettings kAllMaps{
    .with_distortion = true, .with_plane_distance = true, .with_statistics = true};

inline RasterSettings with_lanes(RasterSettings settings, int lanes) {
  settings.lanes = lanes;
  return settings;
}

inline RandomSurfels all_kinds() {
  RandomSurfels options;
  options.edge_on = options.at_camera = options.behind = options.huge = options.tiny = 0.1;
  return options;
}

inline void check_same_bytes(const RasterOutput& a, const RasterOutput& b) {
  CHECK(same_bytes(a.features.values(), b.features.values()));
  CHECK(same_bytes(a.alpha.values(), b.alpha.values()));
  CHECK(same_bytes(a.depth_sum.values(), b.depth_sum.values()));
  CHECK(same_bytes(a.depth_median.values(), b.depth_median.values()));
  CHECK(same_bytes(a.normal.values(), b.normal.values()));
  CHECK(same_bytes(a.distortion.values(), b.distortion.values()));
  CHECK(same_bytes(a.plane_distance.values(), b.plane_distance.values()));
  CHECK(same_bytes(a.owned_pixels, b.owned_pixels));
  CHECK(same_bytes(a.radii, b.radii));
  CHECK(same_bytes(a.visibility, b.visibility));
  CHECK(same_bytes(a.in_view, b.in_view));
}

inline void check_same_bytes(const RasterGradient& a, const RasterGradient& b) {
  CHECK(same_bytes(a.means, b.means));
  CHECK(same_bytes(a.scales, b.scales));
  CHECK(same_bytes(a.rotations, b.rotations));
  CHECK(same_bytes(a.opacities, b.opacities));
  CHECK(same_bytes(a.features, b.features));
  CHECK(same_bytes(a.screen, b.screen));
  CHECK(same_bytes(a.screen_abs, b.screen_abs));
}

struct ForwardBackward {
  RasterOutput output;
  RasterGradient gradient;
};

// The loss is the sum of all maps.
inline ForwardBackward forward_backward(
    Rasterizer& rasterizer, const SurfelArrays& surfels, const Camera& camera, int lanes = 16
) {
  ForwardBackward result;
  const Image one(camera.width, camera.height, 1, 1.0f),
      three(camera.width, camera.height, 3, 1.0f);
  const RasterOutputGradient ones{
      Image(camera.width, camera.height, surfels.channels, 1.0f), one, one, one, three, one, one};
  result.output = rasterizer.forward({surfels.view(), camera, with_lanes(kAllMaps, lanes)});
  result.gradient = rasterizer.backward(ones);
  return result;
}

}  // namespace glint::test
