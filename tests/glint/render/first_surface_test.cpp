// SPDX-License-Identifier: MIT
// First surfaces against the hits of the reference renderer, and in closed cases.
#include "glint/render/first_surface.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>

#include "tests/support/compare_render.h"
#include "tests/support/facing_layers.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr ImageSize kSize{33, 17};

struct Pair {
  double depth, weight;
};

// Written out from the description, on sorted pairs.
double brute_force(std::vector<Pair> pairs, const FirstSurfaceSettings& s) {
  if (pairs.size() > 300) pairs.resize(300);
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return a.depth < b.depth;
  });
  std::vector<Pair> candidates;
  double sum = 0;
  for (const Pair& pair : pairs) {
    candidates.push_back(pair);
    sum += pair.weight;
    if (sum > static_cast<double>(s.weight_window)) break;
  }
  double best = 0, depth = 0;
  for (const Pair& first : candidates) {
    double weight = 0, moment = 0;
    for (const Pair& pair : candidates) {
      const double distance = pair.depth - first.depth;
      if (distance < 0 || distance > static_cast<double>(s.window)) continue;
      weight += pair.weight;
      moment += pair.weight * pair.depth;
    }
    if (weight <= best) continue;
    best = weight;
    depth = moment / weight;
  }
  return depth;
}

double brute_force(const ReferencePixel& pixel, bool masked, const FirstSurfaceSettings& s) {
  if (1 - pixel.alpha > static_cast<double>(s.max_transmittance)) return 0;
  if (!masked) return pixel.depth_median;
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < pixel.depths.size(); ++i)
    pairs.push_back({pixel.depths[i], pixel.weights[i].second});
  return brute_force(pairs, s);
}

// Whether a little rounding of any threshold leaves the answer.
bool is_settled(const ReferencePixel& pixel, bool masked, const FirstSurfaceSettings& s) {
  const double answer = brute_force(pixel, masked, s);
  for (const float factor : {0.99f, 1.01f})
    for (float FirstSurfaceSettings::*field :
         {&FirstSurfaceSettings::window,
          &FirstSurfaceSettings::weight_window,
          &FirstSurfaceSettings::max_transmittance}) {
      FirstSurfaceSettings moved = s;
      moved.*field *= factor;
      if (std::abs(brute_force(pixel, masked, moved) - answer) > 1e-6) return false;
    }
  return is_clean(pixel.cutoffs) && pixel.cutoffs.median > kCutoffGuard;
}

Image first_surface(
    const SurfelArrays& surfels,
    const Camera& camera,
    const Image& mask,
    const FirstSurfaceSettings& settings = {},
    const RasterSettings& raster = {}
) {
  Rasterizer rasterizer;
  rasterizer.forward({surfels.view(), camera, raster});
  Image depth;
  rasterizer.first_surface(mask, settings, depth);
  return depth;
}

double in_the_middle(const SurfelArrays& surfels, float masked = 1) {
  const Image depth = first_surface(surfels, small_camera(), Image(21, 21, 1, masked));
  return static_cast<double>(depth.at(10, 10));
}

}  // namespace

TEST_CASE("First surfaces of random scenes are those of the reference's hits") {
  const std::uint64_t seed = GENERATE(range(1, 7));
  const bool limited = GENERATE(false, true);
  INFO("seed " << seed);
  Rng rng(seed);
  const Camera camera = random_camera(rng, kSize);
  const SurfelArrays surfels =
      random_surfels({.count = 150, .max_opacity = 0.3, .edge_on = 0.1, .tiny = 0.1}, camera, rng);
  Image mask(kSize.width, kSize.height, 1), limit(kSize.width, kSize.height, 1);
  for (float& value : mask.values()) value = rng.uniform() < 0.7f ? 1.0f : 0.0f;
  for (float& value : limit.values()) value = rng.uniform(0, 2);
  RasterInput input = surfels.view();
  if (limited) input.near_limit = limit;
  const FirstSurfaceSettings settings{.window = 0.3f, .weight_window = 0.2f};

  Rasterizer rasterizer;
  rasterizer.forward({input, camera, {}});
  Image depth;
  rasterizer.first_surface(mask, settings, depth);
  REQUIRE(depth.size() == kSize);
  const ReferenceRenderer reference(reference_input(input), camera, {});
  int settled = 0, several = 0;
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const ReferencePixel pixel = reference.pixel(x, y);
      const bool masked = mask.at(x, y) > 0;
      if (!is_settled(pixel, masked, settings)) continue;
      INFO("pixel " << x << ", " << y << ", mask " << masked);
      const double expected = brute_force(pixel, masked, settings);
      CHECK(relative_difference(static_cast<double>(depth.at(x, y)), expected) < 1e-3);
      ++settled;
      several += masked && pixel.weights.size() > 2 ? 1 : 0;
    }
  CHECK(settled > 200);
  CHECK(several > 50);
}

TEST_CASE("SIMD lanes or not, first surfaces are the same") {
  Rng rng(9);
  const Camera camera = random_camera(rng, kSize);
  const SurfelArrays surfels = random_surfels({.count = 200, .max_opacity = 0.4}, camera, rng);
  const Image mask(kSize.width, kSize.height, 1, 1.0f);
  const Image lanes = first_surface(surfels, camera, mask);
  const Image scalar = first_surface(surfels, camera, mask, {}, {.lanes = 1});
  for (std::size_t i = 0; i < lanes.values().size(); ++i)
    CHECK(lanes.values()[i] == Approx(scalar.values()[i]).epsilon(1e-6));
}

TEST_CASE("A single layer is the first surface at its depth") {
  SurfelArrays surfels;
  add_facing(surfels, 2.5, 0.3);
  CHECK(in_the_middle(surfels) == Approx(2.5));
}

TEST_CASE("Layers within the window are one surface at their weighted mean") {
  SurfelArrays surfels;
  add_facing(surfels, 2, 0.05);
  add_facing(surfels, 2.02, 0.3);
  add_facing(surfels, 2.025, 0.9);  // after the cumulative weight has passed 0.1
  const double first = 0.05, second = 0.95 * 0.3;
  CHECK(in_the_middle(surfels) == Approx((2 * first + 2.02 * second) / (first + second)));
}

TEST_CASE("Of layers further apart the heaviest among the first is the surface") {
  SurfelArrays surfels;
  add_facing(surfels, 2, 0.05);
  add_facing(surfels, 2.5, 0.3);
  add_facing(surfels, 3, 0.99);
  CHECK(in_the_middle(surfels) == Approx(2.5));
  CHECK(in_the_middle(surfels, 0) == Approx(3));  // outside the mask: last with T > 0.5
  SurfelArrays glass;
  add_facing(glass, 2, 0.12);
  add_facing(glass, 2.5, 0.99);
  CHECK(in_the_middle(glass) == Approx(2));  // 0.12 > 0.1 ends the candidates
}

TEST_CASE("Where nearly all light is left there is no first surface") {
  CHECK(in_the_middle({}) == 0);
  SurfelArrays surfels;
  add_facing(surfels, 2, 0.015);
  CHECK(in_the_middle(surfels) == 0);
  CHECK(in_the_middle(surfels, 0) == 0);
  add_facing(surfels, 2, 0.015);
  CHECK(in_the_middle(surfels) == Approx(2));
}

TEST_CASE("Only the first 300 hits count") {
  const int layers = GENERATE(299, 300);
  SurfelArrays surfels;
  for (int i = 0; i < layers; ++i) add_facing(surfels, 3 + 1e-5 * i, 0.0045);
  // Its centre lies behind them all, and so it comes last; the middle pixel meets it at z = 1.
  const double half = -std::atan2(3, 1) / 2;
  surfels.add({1, 0, 4}, {6, 6}, {std::cos(half), 0, std::sin(half), 0}, 0.9, {1, 1, 1});
  CHECK(in_the_middle(surfels) == Approx(layers == 299 ? 1 : 3).epsilon(1e-3));
}

TEST_CASE("A first surface is asked for after a rasterisation, with a mask of its size") {
  Rasterizer rasterizer;
  Image depth;
  CHECK_THROWS(rasterizer.first_surface(Image(21, 21, 1), {}, depth));
  SurfelArrays surfels;
  add_facing(surfels, 2, 0.5);
  rasterizer.forward({surfels.view(), small_camera(), {}});
  CHECK_THROWS_WITH(
      rasterizer.first_surface(Image(20, 21, 1), {}, depth), Catch::Contains("20x21x1, expected")
  );
  rasterizer.first_surface(Image(21, 21, 1), {}, depth);
  CHECK(depth.at(10, 10) == Approx(2));
}
