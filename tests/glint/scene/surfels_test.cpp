// SPDX-License-Identifier: MIT
#include "glint/scene/surfels.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "glint/core/rng.h"
#include "tests/support/temp_folder.h"
#include "tests/support/threads.h"

using namespace glint;
using namespace glint::test;

namespace {

PointCloud random_points(std::size_t count) {
  PointCloud points;
  Rng rng(1);
  for (std::size_t i = 0; i < count; ++i) {
    points.positions.push_back({rng.uniform(), rng.uniform(), rng.uniform()});
    points.colors.push_back({rng.uniform(), rng.uniform(), rng.uniform()});
  }
  return points;
}

// Root mean squared distance to the 3 nearest others, by trying all.
double spacing_by_trying(const std::vector<Vec3f>& points, std::size_t i) {
  std::vector<double> squared;
  for (std::size_t j = 0; j < points.size(); ++j)
    if (j != i) squared.push_back(length2(cast<double>(points[i]) - cast<double>(points[j])));
  std::partial_sort(squared.begin(), squared.begin() + 3, squared.end());
  return std::sqrt((squared[0] + squared[1] + squared[2]) / 3);
}

}  // namespace

TEST_CASE("neighbour distances equal those found by trying all points") {
  const PointCloud points = random_points(500);
  const std::vector<float> distances = neighbor_distances(points.positions);
  for (std::size_t i = 0; i < 500; ++i)
    CHECK(distances[i] == Approx(spacing_by_trying(points.positions, i)).epsilon(1e-6));
}

TEST_CASE("coincident points get the smallest spacing, not zero") {
  const std::vector<Vec3f> points(10, Vec3f{1, 2, 3});
  for (const float distance : neighbor_distances(points)) CHECK(distance == Approx(1e-4f));
}

TEST_CASE("three points are too few") {
  PointCloud points = random_points(3);
  bad_reference([&] { surfels_from_points(points, {}); });
  points = random_points(4);
  CHECK(surfels_from_points(points, {}).size() == 4);
}

TEST_CASE("surfels start at the points with their colour, spacing and a random rotation") {
  const PointCloud points = random_points(50);
  InitialSurfels options;
  options.extra = {{"transparency", 0.1f, 0}, {"specular", 0.5f, 0}};
  const SurfelCloud cloud = surfels_from_points(points, options);
  for (std::size_t i = 0; i < 50; ++i) {
    CHECK(cloud.means[3 * i + 1] == points.positions[i].y);
    CHECK(cloud.sh_dc[3 * i + 2] * 0.28209479177387814f + 0.5f == Approx(points.colors[i].z));
    CHECK(std::exp(cloud.log_scales[2 * i]) == Approx(spacing_by_trying(points.positions, i)));
    CHECK(cloud.log_scales[2 * i] == cloud.log_scales[2 * i + 1]);
    CHECK(1 / (1 + std::exp(-cloud.opacity_logits[i])) == Approx(0.1));
    CHECK(1 / (1 + std::exp(-cloud.extra_logits[2 * i])) == Approx(0.1));
    CHECK(cloud.extra_logits[2 * i + 1] == Approx(0).margin(1e-6));
    double norm2 = 0;
    for (std::size_t k = 0; k < 4; ++k)
      norm2 += std::pow(static_cast<double>(cloud.rotations[4 * i + k]), 2);
    CHECK(norm2 == Approx(1));
  }
  CHECK(std::all_of(cloud.sh_rest.begin(), cloud.sh_rest.end(), [](float v) { return v == 0; }));
}

TEST_CASE("the same seed gives the same surfels with any number of threads") {
  const PointCloud points = random_points(2000);
  const auto made = [&] { return surfels_from_points(points, {}); };
  const SurfelCloud one = test::with_threads(1, made), two = test::with_threads(2, made);
  CHECK(one.log_scales == two.log_scales);
  CHECK(one.rotations == two.rotations);
  InitialSurfels other;
  other.seed = 1;
  CHECK(surfels_from_points(points, other).rotations != one.rotations);
}

TEST_CASE("random rotations have no preferred direction") {
  const SurfelCloud cloud = surfels_from_points(random_points(4000), {});
  for (std::size_t k = 0; k < 4; ++k) {
    double mean = 0, square = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const auto q = static_cast<double>(cloud.rotations[4 * i + k]);
      mean += q / 4000;
      square += q * q / 4000;
    }
    // Standard errors: 0.5 / sqrt(4000) and sqrt(1/8 - 1/16) / sqrt(4000); five of them.
    CHECK(std::abs(mean) < 0.04);
    CHECK(std::abs(square - 0.25) < 0.02);
  }
}

TEST_CASE("resizing keeps rows and adds zero ones") {
  SurfelCloud cloud = surfels_from_points(random_points(5), {});
  const FloatArray before = cloud.rotations;
  cloud.resize(7);
  CHECK(cloud.size() == 7);
  CHECK(cloud.sh_rest.size() == 7 * 45);
  CHECK(std::equal(before.begin(), before.end(), cloud.rotations.begin()));
  CHECK(cloud.rotations[27] == 0);
}

TEST_CASE("extra channels start at their values, through their activations, with their spread") {
  InitialSurfels options;
  options.scale = 0.5f;
  options.extra = {
      {"t", 0.25f, 0},
      {"albedo", 0.4f, 0, Activation::kCappedExp},
      {"feature", 0.5f, 0, Activation::kTanh},
      {"noise", 0, 0, Activation::kTanh, 0.1f}};
  const PointCloud points = random_points(4000);
  const SurfelCloud cloud = surfels_from_points(points, options);
  CHECK(cloud.extra_logits[0] == Approx(std::log(0.25 / 0.75)));
  CHECK(cloud.extra_logits[1] == Approx(std::log(5 * 0.4)));
  CHECK(cloud.extra_logits[2] == Approx(std::atanh(0.5)));
  double mean = 0, square = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto x = static_cast<double>(cloud.extra_logits[4 * i + 3]);
    mean += x / 4000;
    square += x * x / 4000;
  }
  CHECK(std::abs(mean) < 0.01);  // six standard errors
  CHECK(square == Approx(0.01).epsilon(0.12));
  const SurfelCloud whole = surfels_from_points(points, {});
  CHECK(cloud.log_scales[7] == Approx(whole.log_scales[7] + std::log(0.5f)));
  CHECK(cloud.rotations == whole.rotations);
}

TEST_CASE("a cloud of a file gets its activations, and other channels are refused") {
  const std::vector<ExtraChannel> extra = {
      {"albedo", 1, 0, Activation::kCappedExp}, {"t", 0.5f, 0}};
  SurfelCloud cloud;
  cloud.extra_names = {"albedo", "t"};
  set_activations(extra, "a.ply", cloud);
  CHECK(
      cloud.extra_activations ==
      std::vector<Activation>{Activation::kCappedExp, Activation::kSigmoid}
  );
  cloud.extra_names = {"specular"};
  CHECK_THROWS_WITH(
      set_activations(extra, "a.ply", cloud),
      Catch::Contains("a.ply") && Catch::Contains("[specular], expected [albedo, t]")
  );
}
