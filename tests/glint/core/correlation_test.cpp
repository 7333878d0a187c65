// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>

#include "glint/core/correlation.h"

using namespace glint;

TEST_CASE("Correlation: closed forms, blind to gain and offset, 0 where nothing varies") {
  const std::vector<double> a{1, 2, 3, 4};
  CHECK(covariance(a, a) == Approx(1.25));
  CHECK(correlation(a, {5, 7, 9, 11}) == Approx(1));
  CHECK(correlation(a, {-10, -20, -30, -40}) == Approx(-1));
  CHECK(correlation(a, {1, -1, -1, 1}) == Approx(0).margin(1e-12));
  CHECK(correlation(a, {1, 3, 2, 4}) == Approx(0.8));
  CHECK(correlation(a, {7, 7, 7, 7}) == 0);
}
