// SPDX-License-Identifier: MIT
#include "metrics/mesh/samples.h"

#include <catch2/catch.hpp>
#include <cstring>

#include "glint/core/parallel.h"
#include "tests/metrics/mesh/shapes.h"

using namespace glint;
using namespace glint::test;

namespace {

bool same_bytes(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3f)) == 0;
}

}  // namespace

TEST_CASE("samples fall on faces by area, to within one") {
  // Floors of 1, 2 and 7 square metres at heights 0, 1, 2, in cells of very different size.
  TriangleMesh mesh = parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 30, 30);
  append(mesh, parallelogram({0, 0, 1}, {2, 0, 0}, {0, 1, 0}));
  append(mesh, parallelogram({0, 0, 2}, {7, 0, 0}, {0, 1, 0}, 5, 1));
  const SurfacePoints samples = sample_surface(mesh, 10'000, 1);
  int counts[3] = {0, 0, 0};
  for (const Vec3f& position : samples.positions) ++counts[static_cast<int>(position.z)];
  CHECK(std::abs(counts[0] - 1000) <= 1);
  CHECK(std::abs(counts[1] - 2000) <= 1);
  CHECK(std::abs(counts[2] - 7000) <= 1);
}

TEST_CASE("samples are uniform on a triangle: mean and second moments") {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.faces = {{0, 1, 2}};
  constexpr std::size_t kCount = 200'000;
  double x = 0, y = 0, xx = 0, xy = 0;
  for (const Vec3f& position : sample_surface(mesh, kCount, 5).positions) {
    const Vec3d p = cast<double>(position);
    CHECK((p.x >= 0 && p.y >= 0 && p.x + p.y <= 1 + 1e-6));
    x += p.x / kCount, y += p.y / kCount, xx += p.x * p.x / kCount, xy += p.x * p.y / kCount;
  }
  // E x = 1/3, E x^2 = 1/6, E xy = 1/12; five standard errors, none above 0.25 / sqrt(n).
  const double margin = 5 * 0.25 / std::sqrt(static_cast<double>(kCount));
  CHECK(x == Approx(1.0 / 3).margin(margin));
  CHECK(y == Approx(1.0 / 3).margin(margin));
  CHECK(xx == Approx(1.0 / 6).margin(margin));
  CHECK(xy == Approx(1.0 / 12).margin(margin));
}

TEST_CASE("normals are the faces', of unit length") {
  const TriangleMesh mesh = parallelogram({1, 2, 3}, {0, 2, 0}, {0, 0, 3});
  for (const Vec3f& normal : sample_surface(mesh, 50, 0).normals)
    CHECK(length(normal - Vec3f{1, 0, 0}) < 1e-6f);
}

TEST_CASE("the seed makes the samples, the number of threads does not") {
  const TriangleMesh mesh = sphere(1, 20);
  set_num_threads(1);
  const SurfacePoints one = sample_surface(mesh, 50'000, 3);
  set_num_threads(2);
  const SurfacePoints two = sample_surface(mesh, 50'000, 3);
  set_num_threads(0);
  CHECK(same_bytes(one.positions, two.positions));
  CHECK(same_bytes(one.normals, two.normals));
  CHECK_FALSE(same_bytes(one.positions, sample_surface(mesh, 50'000, 4).positions));
}

TEST_CASE("a point cloud is its own samples, or a uniform subset of them") {
  SurfacePoints cloud;
  for (int i = 0; i < 1000; ++i) cloud.positions.push_back({static_cast<float>(i), 0, 0});
  CHECK(same_bytes(sample_surface(cloud, 1000, 0).positions, cloud.positions));
  cloud.normals.assign(1000, {0, 0, 1});
  const SurfacePoints subset = sample_surface(cloud, 400, 0);
  REQUIRE(subset.positions.size() == 400);
  CHECK(subset.normals.size() == 400);
  int first_half = 0;
  for (std::size_t i = 0; i < 400; ++i) {
    if (i > 0) CHECK(subset.positions[i].x > subset.positions[i - 1].x);  // none twice
    first_half += subset.positions[i].x < 500;
  }
  CHECK(std::abs(first_half - 200) < 39);  // five standard errors of the hypergeometric count, 7.75
  CHECK_FALSE(same_bytes(subset.positions, sample_surface(cloud, 400, 1).positions));
}
