// SPDX-License-Identifier: MIT
#include "reports/show/tables/agreement.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <vector>

using namespace glint;

namespace {

// A method with one value in each of `pairs` scenes.
ComparedMethod method(double published, const std::vector<double>& values) {
  ComparedMethod result;
  result.published = published;
  for (std::size_t i = 0; i < values.size(); ++i)
    result.values[{"room_" + std::to_string(i), 0}] = values[i];
  result.measured = mean_of(values);
  return result;
}

}  // namespace

// Orders by their number of inversions k, tau = 1 - 4 k / (n (n - 1)): of 6 methods 1, 5, 14 have k
// = 0, 1, 2, and as many n (n - 1) / 2 - k; 12 of 720 orders (1.7 %) are beyond k = 2, 40 (5.6 %)
// are with it.
TEST_CASE("what chance gives is that of all orders") {
  CHECK(chance_interval(0).high == 1);
  CHECK(chance_interval(2).high == 1);
  CHECK(chance_interval(4).high == 1);  // 2 of 24 orders are more than 5 %
  CHECK(chance_interval(5).high == Approx(0.8));
  CHECK(chance_interval(6).high == Approx(1 - 4 * 2 / 30.0));
  CHECK(chance_interval(6).low == -chance_interval(6).high);
  CHECK(chance_interval(12).high < chance_interval(8).high);  // sampled
}

TEST_CASE("an order that every scene agrees on has no spread, one that hangs on a scene has") {
  const std::vector<ComparedMethod> sure = {
      method(1, {1, 1, 1}), method(2, {2, 2, 2}), method(3, {3, 3, 3})};
  const auto agreed = order_agreement(sure);
  REQUIRE(agreed);
  CHECK(agreed->tau == 1);
  CHECK(agreed->num_methods == 3);
  REQUIRE(agreed->interval);
  CHECK(agreed->interval->low == 1);
  CHECK(agreed->interval->high == 1);

  const std::vector<ComparedMethod> unsure = {
      method(1, {0, 0, 3}), method(2, {2, 2, 2}), method(3, {3, 3, 0})};
  const auto spread = order_agreement(unsure);
  REQUIRE(spread);
  CHECK(spread->tau == Approx(2 / std::sqrt(6.0)));  // means 1, 2, 2: one tie
  REQUIRE(spread->interval);
  CHECK(spread->interval->low < 0);
  CHECK(spread->interval->high == 1);
}

TEST_CASE("no interval of few scenes, and only scenes that all methods have count") {
  CHECK_FALSE(order_agreement(std::vector{method(1, {1, 2}), method(2, {2, 3})})->interval);
  const auto partial = order_agreement(std::vector{method(1, {1, 2, 3, 4}), method(2, {4, 5})});
  REQUIRE(partial);
  CHECK(partial->tau == 1);
  CHECK_FALSE(partial->interval);
}

TEST_CASE("agreement is not defined for one method or for equal values") {
  CHECK_FALSE(order_agreement(std::vector{method(1, {1, 2, 3})}));
  CHECK_FALSE(order_agreement(std::vector{method(1, {1, 1, 1}), method(2, {1, 1, 1})}));
  CHECK_FALSE(order_agreement({}));
}

TEST_CASE("columns together have the mean of their taus, and draw the same rooms") {
  const std::vector<ComparedMethod> agrees = {
      method(1, {1, 1, 1}), method(2, {2, 2, 2}), method(3, {3, 3, 3})};
  const std::vector<ComparedMethod> reversed = {
      method(3, {1, 1, 1}), method(2, {2, 2, 2}), method(1, {3, 3, 3})};
  const auto mean = mean_order_agreement(std::vector{agrees, reversed});
  REQUIRE(mean);
  CHECK(mean->tau == Approx(0).margin(1e-12));
  CHECK(mean->interval->low == Approx(0).margin(1e-12));
  CHECK(mean->chance.high == Approx(0).margin(1e-12));  // whatever one gains the other loses
  const std::vector<std::vector<ComparedMethod>> one{agrees};
  const auto alone = mean_order_agreement(one), as_one = order_agreement(agrees);
  CHECK(alone->tau == as_one->tau);
  CHECK(alone->interval->low == as_one->interval->low);
  CHECK(alone->chance.high == as_one->chance.high);
  CHECK_FALSE(mean_order_agreement({}));
}
