// SPDX-License-Identifier: MIT
#include "reports/tables/statistics.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <vector>

using namespace glint;

TEST_CASE("the spread is a range of two values and a sample deviation of more") {
  CHECK(spread_of(std::vector<double>{3}) == 0);
  CHECK(spread_of(std::vector<double>{3, 1}) == 2);
  CHECK(spread_of(std::vector<double>{1, 2, 4}) == Approx(std::sqrt(7.0 / 3)));
  CHECK(mean_of(std::vector<double>{1, 2, 6}) == 3);
}

TEST_CASE("fewer than three pairs have no interval") {
  CHECK_FALSE(bootstrap_interval(std::vector<double>{1, 1}).has_value());
  CHECK(bootstrap_interval(std::vector<double>{1, 1, 1}).has_value());
}

TEST_CASE("equal differences have an interval of no width") {
  const Interval interval = *bootstrap_interval(std::vector<double>{0.5, 0.5, 0.5, 0.5});
  CHECK(interval.low == 0.5);
  CHECK(interval.high == 0.5);
  CHECK_FALSE(interval.contains(0));
}

TEST_CASE("the interval of many values is that of a normal distribution of the mean") {
  std::vector<double> values;
  for (int i = 0; i < 400; ++i) values.push_back(i % 2 ? 1 : -1);  // deviation 1, mean 0
  const Interval interval = *bootstrap_interval(values);
  CHECK(interval.low == Approx(-1.96 / 20).margin(0.005));
  CHECK(interval.high == Approx(1.96 / 20).margin(0.005));
}

TEST_CASE("the interval is the same every time") {
  const std::vector<double> values = {0.3, -0.1, 0.4, 0.2};
  CHECK(bootstrap_interval(values)->low == bootstrap_interval(values)->low);
  CHECK(bootstrap_interval(values)->low > -0.1);
  CHECK(bootstrap_interval(values)->high < 0.4);
}
