// SPDX-License-Identifier: MIT
#include "reports/show/tables/statistics.h"

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

using Values = std::vector<std::vector<double>>;

// One seed of each scene.
Values scenes_of(const std::vector<double>& values) {
  Values scenes;
  for (const double value : values) scenes.push_back({value});
  return scenes;
}

TEST_CASE("fewer than three pairs have no interval") {
  CHECK_FALSE(bootstrap_interval(Values{}).has_value());
  CHECK_FALSE(bootstrap_interval(Values{{1}, {1}}).has_value());
  CHECK(bootstrap_interval(Values{{1}, {1, 1}}).has_value());
}

TEST_CASE("equal differences have an interval of no width") {
  const Interval interval = *bootstrap_interval(Values{{0.5, 0.5}, {0.5}, {0.5}});
  CHECK(interval.low == Approx(0.5).epsilon(1e-12));
  CHECK(interval.high == Approx(0.5).epsilon(1e-12));
  CHECK_FALSE(interval.contains(0));
}

TEST_CASE("the interval of many values is that of a normal distribution of the mean") {
  std::vector<double> values;
  for (int i = 0; i < 400; ++i) values.push_back(i % 2 ? 1 : -1);  // deviation 1, mean 0
  const Interval interval = *bootstrap_interval(scenes_of(values));
  CHECK(interval.low == Approx(-1.96 / 20).margin(0.005));
  CHECK(interval.high == Approx(1.96 / 20).margin(0.005));
}

TEST_CASE("seeds of a scene that are alike say no more than one of them") {
  std::vector<double> one;
  Values alike;
  for (int i = 0; i < 100; ++i) {
    one.push_back(i % 2 ? 1 : -1);
    alike.push_back({one.back(), one.back(), one.back()});
  }
  const Interval of_one = *bootstrap_interval(scenes_of(one)),
                 interval = *bootstrap_interval(alike);
  CHECK(interval.low == Approx(of_one.low).margin(0.01));
  CHECK(interval.high == Approx(of_one.high).margin(0.01));
}

TEST_CASE("seeds that differ widen the interval, as much as their mean varies") {
  const Values scenes(50, {1, -1});  // the mean of two draws of a scene: variance 1/2
  const Interval interval = *bootstrap_interval(scenes);
  CHECK(interval.high == Approx(1.96 * std::sqrt(0.5 / 50)).margin(0.01));
}

TEST_CASE("the weights of a resample sum to 1, whatever the seeds") {
  Rng rng(3);
  for (int i = 0; i < 20; ++i) {
    double sum = 0;
    draw_resample(std::vector<std::size_t>{1, 3, 2}, rng, [&](std::size_t, std::size_t, double w) {
      sum += w;
    });
    CHECK(sum == Approx(1).epsilon(1e-12));
  }
}

TEST_CASE("scenes far apart make the interval, seeds alone do not: drawing both is wider") {
  const Values values{{10, 10.2}, {20, 20.2}, {30, 30.2}};
  const Interval both = *bootstrap_interval(values, kMeanResamples);
  CHECK(both.low < 13);  // the means of three draws of three scenes: 10 in one of 27
  CHECK(both.high > 27);
  const Values one{{10, 10.1, 10.2}};  // of one scene: seeds alone
  const Interval seeds = *bootstrap_interval(one, kMeanResamples);
  CHECK(seeds.low >= 10);
  CHECK(seeds.high <= 10.2);
}

TEST_CASE("of two scenes whose seeds agree the resampled mean is one of three values") {
  const Interval interval = *bootstrap_interval(Values{{0, 0}, {1, 1}}, kMeanResamples);
  CHECK(interval.low == 0);  // each end in a quarter of the resamples
  CHECK(interval.high == 1);
}

TEST_CASE("the interval is the same every time") {
  const Values values = scenes_of({0.3, -0.1, 0.4, 0.2});
  CHECK(bootstrap_interval(values)->low == bootstrap_interval(values)->low);
  CHECK(bootstrap_interval(values)->low > -0.1);
  CHECK(bootstrap_interval(values)->high < 0.4);
}
