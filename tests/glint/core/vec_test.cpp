// SPDX-License-Identifier: MIT
#include "glint/core/vec.h"

#include <catch2/catch.hpp>

#include "tests/support/gradcheck.h"

using namespace glint;

namespace {

constexpr Vec3d kA{1, -2, 3}, kB{0.5, 4, -1};
const Mat3d kM{{{1, 2, 3}, {4, 5, 6}, {7, 8, 10}}};

void check_equal(Vec3d actual, Vec3d expected) {
  for (int i = 0; i < 3; ++i) CHECK(actual[i] == Approx(expected[i]).margin(1e-14));
}

}  // namespace

TEST_CASE("The cross product is right-handed and perpendicular to both factors") {
  check_equal(cross(Vec3d{1, 0, 0}, Vec3d{0, 1, 0}), {0, 0, 1});
  check_equal(cross(kA, kB), {-10, 2.5, 5});
  CHECK(dot(cross(kA, kB), kA) == Approx(0).margin(1e-14));
}

TEST_CASE("Lengths and unit vectors agree") {
  CHECK(dot(kA, kB) == -10.5);
  CHECK(length2(kA) == 14);
  CHECK(length(kA) == Approx(std::sqrt(14.0)));
  CHECK(length(normalize(kA)) == Approx(1));
  check_equal(length(kA) * normalize(kA), kA);
}

TEST_CASE("Matrices are row-major and multiply column vectors") {
  check_equal(kM * Vec3d{1, 0, 0}, column(kM, 0));
  check_equal(kM * kA, {6, 12, 21});
  check_equal(transpose_times(kM, kA), transpose(kM) * kA);
  check_equal((kM * transpose(kM)) * kA, kM * (transpose(kM) * kA));
  CHECK(determinant(kM) == Approx(-3));
}

TEST_CASE("The gradient of normalisation matches central differences") {
  const Vec3d weights{0.3, -1.2, 0.7};
  const Vec3d vjp = normalize_vjp(normalize(kA), length(kA), weights);
  const std::vector<double> expected = test::central_differences(
      [&](const std::vector<double>& x) {
        return dot(weights, normalize(Vec3d{x[0], x[1], x[2]}));
      },
      {kA.x, kA.y, kA.z}
  );
  for (int i = 0; i < 3; ++i) CHECK(vjp[i] == Approx(expected[static_cast<std::size_t>(i)]));
}

TEST_CASE("Selection and casts act on each component") {
  check_equal(select(true, kA, kB), kA);
  check_equal(select(false, kA, kB), kB);
  CHECK(cast<float>(kB).y == 4.0f);
  check_equal(hadamard(kA, kB), {0.5, -8, -3});
}
