// SPDX-License-Identifier: MIT
#include "glint/core/real.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace glint;

namespace {

// Largest relative error of exp_fast<float> over [low, high], from a million points.
double largest_error(double low, double high) {
  double largest = 0;
  constexpr int kPoints = 1'000'000;
  for (int i = 0; i <= kPoints; ++i) {
    const auto x = static_cast<float>(low + (high - low) * i / kPoints);
    const double exact = std::exp(static_cast<double>(x));
    largest = std::max(largest, std::abs(static_cast<double>(exp_fast(x)) / exact - 1));
  }
  return largest;
}

}  // namespace

TEST_CASE("The polynomial exponential keeps its promised relative error") {
  CHECK(largest_error(-87, 87) < 1e-7);
  CHECK(largest_error(-4.5, 0) < 1e-7);  // the range of splats
}

TEST_CASE("The polynomial exponential is exact at zero and clamps its argument") {
  CHECK(exp_fast(0.0f) == 1.0f);
  CHECK(exp_fast(-1e30f) == exp_fast(-87.0f));
  CHECK(exp_fast(1e30f) == exp_fast(87.0f));
  CHECK(exp_fast(-87.0f) > 0);
  CHECK(std::isfinite(exp_fast(87.0f)));
}

TEST_CASE("The polynomial exponential does not decrease") {
  for (float x = -5; x < 0; x += 1e-3f) CHECK(exp_fast(x) <= exp_fast(x + 1e-3f));
}

TEST_CASE("In double the exponential is that of the library") {
  CHECK(exp_fast(-1.25) == std::exp(-1.25));
}

TEST_CASE("Powers of two have no error") {
  for (int k = -126; k <= 126; ++k)
    CHECK(times_exp2(1.0f, static_cast<float>(k) + kRoundingShift) == std::ldexp(1.0f, k));
}

TEST_CASE("keep is the value or zero") {
  CHECK(keep(true, 2.5f) == 2.5f);
  CHECK(keep(false, NAN) == 0.0f);
  CHECK(keep(false, 2.5) == 0.0);
}
