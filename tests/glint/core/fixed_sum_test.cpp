// SPDX-License-Identifier: MIT
#include "glint/core/fixed_sum.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace glint;

namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

double sum_of(const std::vector<double>& terms) {
  std::int64_t memory = 0;
  const FixedSums sums{&memory};
  for (const double term : terms) sums.add(0, term);
  const double sum = sums.take(0);
  CHECK(memory == 0);
  return sum;
}

}  // namespace

TEST_CASE("Fixed sums are those of their terms, each held within 2^20") {
  CHECK(sum_of({}) == 0);
  CHECK(sum_of({0.5, -2, 3.25}) == 1.75);
  CHECK(sum_of({1e30, -5}) == 1048576 - 5);
  CHECK(sum_of(std::vector<double>(512, -1e30)) == -512.0 * 1048576);
}

TEST_CASE("A fixed sum with a term that is NaN is NaN, in whatever order terms come") {
  std::vector<double> terms(512, 1e30);
  terms[0] = terms[1] = kNotANumber;
  CHECK(std::isnan(sum_of(terms)));
  std::reverse(terms.begin(), terms.end());
  CHECK(std::isnan(sum_of(terms)));
  std::fill(terms.begin(), terms.end() - 2, -1e30);
  CHECK(std::isnan(sum_of(terms)));
  std::reverse(terms.begin(), terms.end());
  CHECK(std::isnan(sum_of(terms)));
  CHECK(std::isnan(sum_of(std::vector<double>(4, kNotANumber))));
}

TEST_CASE("A fixed sum beyond 2^29 is NaN, and the next one at its place begins at zero") {
  CHECK(std::isnan(sum_of(std::vector<double>(513, 1e30))));
  CHECK(std::isnan(sum_of(std::vector<double>(600, -1e30))));
  std::int64_t memory = 0;
  const FixedSums sums{&memory};
  sums.add(0, kNotANumber);
  CHECK(std::isnan(sums.take(0)));
  sums.add(0, 2);
  CHECK(sums.take(0) == 2);
}
