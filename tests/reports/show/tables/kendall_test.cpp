// SPDX-License-Identifier: MIT
#include "reports/show/tables/kendall.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <vector>

using namespace glint;

TEST_CASE("Kendall's tau is one for the same order and minus one for the reversed") {
  const std::vector<double> a{1, 2, 5, 9}, same{10, 20, 21, 40}, reversed{4, 3, 2, 1};
  CHECK(kendall_tau(a, same) == 1);
  CHECK(kendall_tau(a, reversed) == -1);
}

TEST_CASE("one swapped neighbour of four costs a third") {
  // 5 of 6 pairs agree: (5 - 1) / 6.
  const std::vector<double> a{1, 2, 3, 4}, b{1, 3, 2, 4};
  CHECK(kendall_tau(a, b) == Approx(2.0 / 3).epsilon(1e-15));
}

TEST_CASE("ties shrink the denominator as in tau-b") {
  // Pairs: (1,2) tied in b, the other two agree: 2 / sqrt(3 * 2).
  const std::vector<double> a{1, 2, 3}, b{1, 1, 2};
  CHECK(kendall_tau(a, b) == Approx(2.0 / std::sqrt(6.0)).epsilon(1e-15));
}

TEST_CASE("an order of fewer than two methods, or of equal ones, says nothing") {
  const std::vector<double> one{1}, constant{2, 2}, two{1, 3};
  CHECK(std::isnan(kendall_tau(one, one)));
  CHECK(std::isnan(kendall_tau({}, {})));
  CHECK(std::isnan(kendall_tau(constant, two)));
}
