// SPDX-License-Identifier: MIT
// Modes of depth against the hits of the reference renderer, and in closed cases.
#include "glint/render/depth_modes.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "tests/support/compare_render.h"
#include "tests/support/facing_layers.h"
#include "tests/support/same_bytes.h"
#include "tests/support/threads.h"

using namespace glint;
using namespace glint::test;

namespace {

constexpr ImageSize kSize{33, 17};

struct Modes {
  Image first, last;
};

Modes depth_modes(
    const RasterInput& input, const Camera& camera, const DepthModeSettings& settings = {}
) {
  Rasterizer rasterizer;
  rasterizer.forward({input, camera, {}});
  Modes modes;
  rasterizer.depth_modes(settings, modes.first, modes.last);
  return modes;
}

struct Layer {
  double depth, opacity;
};

// Of facing layers, at the middle pixel.
std::pair<double, double> in_the_middle(std::initializer_list<Layer> layers) {
  SurfelArrays surfels;
  for (const Layer& layer : layers) add_facing(surfels, layer.depth, layer.opacity);
  const Modes modes = depth_modes(surfels.view(), small_camera());
  return {modes.first.at(10, 10), modes.last.at(10, 10)};
}

// Written out from the description: all places, their densities, then the maxima among them.
struct Pair {
  double depth, weight;
};

double density_at(const std::vector<Pair>& hits, double depth, double width) {
  double sum = 0;
  for (const Pair& hit : hits)
    sum += hit.weight * std::max(0.0, 1 - std::abs(hit.depth - depth) / (width * depth));
  return sum;
}

std::vector<double> places_of(const std::vector<Pair>& hits) {
  std::vector<double> places;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (i > 0) places.push_back((hits[i - 1].depth + hits[i].depth) / 2);
    places.push_back(hits[i].depth);
  }
  return places;
}

std::vector<double> maxima_of(const std::vector<Pair>& hits, const DepthModeSettings& s) {
  const std::vector<double> places = places_of(hits);
  std::vector<double> density, maxima;
  for (const double z : places)
    density.push_back(density_at(hits, z, static_cast<double>(s.width)));
  std::size_t top = 0;
  for (std::size_t i = 1; i < places.size(); ++i) {
    const double lowest = *std::min_element(density.begin() + top, density.begin() + i + 1);
    if (lowest < static_cast<double>(s.valley) * std::min(density[top], density[i])) {
      maxima.push_back(places[top]);
      top = i;
    } else if (density[i] > density[top]) {
      top = i;
    }
  }
  if (!places.empty()) maxima.push_back(places[top]);
  return maxima;
}

std::pair<double, double> brute_force(const ReferencePixel& pixel, const DepthModeSettings& s) {
  std::vector<Pair> hits;
  double total = 0;
  for (std::size_t i = 0; i < pixel.depths.size(); ++i) {
    hits.push_back({pixel.depths[i], pixel.weights[i].second});
    total += hits.back().weight;
  }
  std::stable_sort(hits.begin(), hits.end(), [](const Pair& a, const Pair& b) {
    return a.depth < b.depth;
  });
  std::pair<double, double> modes{0, 0};
  for (const double top : maxima_of(hits, s)) {
    double weight = 0, moment = 0;
    for (const Pair& hit : hits) {
      if (std::abs(hit.depth - top) > static_cast<double>(s.width) * top) continue;
      weight += hit.weight;
      moment += hit.weight * hit.depth;
    }
    if (weight < static_cast<double>(s.share) * total) continue;
    modes.second = moment / weight;
    if (modes.first == 0) modes.first = modes.second;
  }
  return modes;
}

// Whether a little rounding of any threshold leaves the answer.
bool is_settled(const ReferencePixel& pixel, const DepthModeSettings& s) {
  const auto answer = brute_force(pixel, s);
  for (const float factor : {0.99f, 1.01f})
    for (float DepthModeSettings::*field :
         {&DepthModeSettings::width, &DepthModeSettings::valley, &DepthModeSettings::share}) {
      DepthModeSettings moved = s;
      moved.*field *= factor;
      const auto other = brute_force(pixel, moved);
      if (std::abs(other.first - answer.first) > 1e-6) return false;
      if (std::abs(other.second - answer.second) > 1e-6) return false;
    }
  return is_clean(pixel.cutoffs);
}

}  // namespace

TEST_CASE("Modes of random scenes are those of the reference's hits") {
  const std::uint64_t seed = GENERATE(range(1, 7));
  const bool limited = GENERATE(false, true);
  INFO("seed " << seed);
  Rng rng(seed);
  const Camera camera = random_camera(rng, kSize);
  const SurfelArrays surfels =
      random_surfels({.count = 150, .max_opacity = 0.3, .edge_on = 0.1, .tiny = 0.1}, camera, rng);
  Image limit(kSize.width, kSize.height, 1);
  for (float& value : limit.values()) value = rng.uniform(0, 2);
  RasterInput input = surfels.view();
  if (limited) input.near_limit = limit;
  const DepthModeSettings settings{.width = 0.1f};

  const Modes modes = depth_modes(input, camera, settings);
  REQUIRE(modes.first.size() == kSize);
  REQUIRE(modes.last.size() == kSize);
  const ReferenceRenderer reference(reference_input(input), camera, {});
  int settled = 0, several = 0;
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const ReferencePixel pixel = reference.pixel(x, y);
      if (!is_settled(pixel, settings)) continue;
      INFO("pixel " << x << ", " << y);
      const auto [first, last] = brute_force(pixel, settings);
      CHECK(relative_difference(static_cast<double>(modes.first.at(x, y)), first) < 1e-3);
      CHECK(relative_difference(static_cast<double>(modes.last.at(x, y)), last) < 1e-3);
      ++settled;
      several += first < last ? 1 : 0;
    }
  CHECK(settled > 200);
  CHECK(several > 50);
}

TEST_CASE("Modes have the same bytes with any number of threads") {
  Rng rng(9);
  const Camera camera = random_camera(rng, kSize);
  const SurfelArrays surfels = random_surfels({.count = 200, .max_opacity = 0.4}, camera, rng);
  const auto run = [&] { return depth_modes(surfels.view(), camera); };
  const Modes one = with_threads(1, run), two = with_threads(2, run);
  CHECK(same_bytes(one.first, two.first));
  CHECK(same_bytes(one.last, two.last));
}

TEST_CASE("One layer is the first mode and the last, at its depth") {
  const auto [first, last] = in_the_middle({{2.5, 0.3}});
  CHECK(first == Approx(2.5));
  CHECK(last == first);
}

TEST_CASE("Two layers are two modes, whatever the depth of the picture is") {
  const auto [first, last] = in_the_middle({{2, 0.3}, {3, 0.99}});
  CHECK(first == Approx(2));
  CHECK(last == Approx(3));
}

TEST_CASE("Of more layers the nearest and the farthest count") {
  const auto [first, last] = in_the_middle({{2, 0.2}, {3, 0.5}, {4, 0.9}});
  CHECK(first == Approx(2));
  CHECK(last == Approx(4));
}

TEST_CASE("A layer with less than the share of the weight is none, in front or behind") {
  CHECK(in_the_middle({{2, 0.04}, {3, 0.99}}).first == Approx(3));
  CHECK(in_the_middle({{2, 0.06}, {3, 0.99}}).first == Approx(2));
  CHECK(in_the_middle({{2, 0.96}, {3, 0.99}}).second == Approx(2));
  CHECK(in_the_middle({{2, 0.9}, {3, 0.99}}).second == Approx(3));
}

TEST_CASE("The share is of what the pixel has, not of all light") {
  const auto [first, last] = in_the_middle({{2, 0.01}, {3, 0.02}});
  CHECK(first == Approx(2));
  CHECK(last == Approx(3));
}

TEST_CASE("Layers within the kernel are one mode at their weighted mean") {
  const double w1 = 0.2, w2 = 0.8 * 0.5;
  const auto [first, last] = in_the_middle({{2, 0.2}, {2.02, 0.5}});
  CHECK(first == Approx((2 * w1 + 2.02 * w2) / (w1 + w2)));
  CHECK(last == first);
}

TEST_CASE("Layers without a valley between them are one mode, whose hits are those near its top") {
  // Equal weights of 0.2; each neighbour adds a quarter of its weight to a layer's density.
  const auto [first, last] = in_the_middle({{2, 0.2}, {2.03, 0.25}, {2.06, 1 / 3.0}});
  CHECK(first == Approx(2.03));
  CHECK(last == first);
  const auto apart = in_the_middle({{2, 0.2}, {2.2, 0.25}, {2.4, 1 / 3.0}});
  CHECK(apart.first == Approx(2));
  CHECK(apart.second == Approx(2.4));
}

TEST_CASE("Modes are in order of depth where hits are not in order of centres") {
  SurfelArrays surfels;
  add_facing(surfels, 3, 0.5);
  // Its centre lies behind, and so it comes last; the middle pixel meets it at z = 1.
  const double half = -std::atan2(3, 1) / 2;
  surfels.add({1, 0, 4}, {6, 6}, {std::cos(half), 0, std::sin(half), 0}, 0.9, {1, 1, 1});
  const Modes modes = depth_modes(surfels.view(), small_camera());
  CHECK(modes.first.at(10, 10) == Approx(1).epsilon(1e-3));
  CHECK(modes.last.at(10, 10) == Approx(3));
}

TEST_CASE("Without hits there is no mode, without a rasterisation an error") {
  const auto [first, last] = in_the_middle({});
  CHECK(first == 0);
  CHECK(last == 0);
  Rasterizer rasterizer;
  Modes modes;
  CHECK_THROWS(rasterizer.depth_modes({}, modes.first, modes.last));
}
