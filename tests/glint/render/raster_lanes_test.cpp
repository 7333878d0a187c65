// SPDX-License-Identifier: MIT
// The rasteriser's lanes: one, eight and sixteen pixels at a time.
#include <algorithm>
#include <cmath>
#include <span>

#include "glint/render/raster_wide.h"
#include "tests/support/forward_backward.h"

using namespace glint;
using namespace glint::test;

TEST_CASE("The scalar instantiation gives what the SIMD one gives, within rounding") {
  const auto [width, height] = GENERATE(table<int, int>({{1, 1}, {33, 17}, {100, 75}}));
  Rng rng(10);
  const Camera camera = random_camera(rng, {width, height});
  const SurfelArrays surfels = random_surfels(all_kinds(), camera, rng);
  Rasterizer rasterizer;
  const ForwardBackward simd = forward_backward(rasterizer, surfels, camera);
  const ForwardBackward scalar = forward_backward(rasterizer, surfels, camera, 1);
  // The same operations on every lane: maps agree to the last bits, so no cut-off can flip.
  const auto check = [](std::span<const float> a, std::span<const float> b, float tolerance) {
    REQUIRE(a.size() == b.size());
    float largest = 0, difference = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      largest = std::max(largest, std::abs(a[i]));
      difference = std::max(difference, std::abs(a[i] - b[i]));
    }
    CHECK(difference <= tolerance * largest);
  };
  check(simd.output.features.values(), scalar.output.features.values(), 1e-6f);
  check(simd.output.depth_sum.values(), scalar.output.depth_sum.values(), 1e-6f);
  check(simd.output.normal.values(), scalar.output.normal.values(), 1e-6f);
  check(simd.output.distortion.values(), scalar.output.distortion.values(), 1e-6f);
  check(simd.output.plane_distance.values(), scalar.output.plane_distance.values(), 1e-6f);
  check(simd.output.owned_pixels, scalar.output.owned_pixels, 0);
  check(simd.output.radii, scalar.output.radii, 0);
  // Gradients sum over pixels in another order.
  check(simd.gradient.means, scalar.gradient.means, 1e-5f);
  check(simd.gradient.scales, scalar.gradient.scales, 1e-5f);
  check(simd.gradient.rotations, scalar.gradient.rotations, 1e-5f);
  check(simd.gradient.opacities, scalar.gradient.opacities, 1e-5f);
  check(simd.gradient.features, scalar.gradient.features, 1e-5f);
  check(simd.gradient.screen_abs, scalar.gradient.screen_abs, 1e-5f);
}

TEST_CASE("Eight and sixteen lanes give the same bytes") {
  if (!has_wide_tiles()) {
    WARN("this processor, or this build, has no sixteen lanes: not compared");
    return;
  }
  const auto [width, height] = GENERATE(table<int, int>({{1, 1}, {33, 17}, {100, 75}}));
  const int channels = GENERATE(3, 5, 7);
  Rng rng(10);
  const Camera camera = random_camera(rng, {width, height});
  RandomSurfels options = all_kinds();
  options.channels = channels;
  options.count = 400;  // so many that pixels stop
  const SurfelArrays surfels = random_surfels(options, camera, rng);
  Rasterizer rasterizer;
  const ForwardBackward eight = forward_backward(rasterizer, surfels, camera, 8);
  const ForwardBackward sixteen = forward_backward(rasterizer, surfels, camera, 16);
  check_same_bytes(eight.output, sixteen.output);
  check_same_bytes(eight.gradient, sixteen.gradient);
}
