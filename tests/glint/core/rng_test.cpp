// SPDX-License-Identifier: MIT
#include "glint/core/rng.h"

#include <array>
#include <catch2/catch.hpp>

using namespace glint;

TEST_CASE("The generator gives the published PCG32 sequence") {
  Rng rng(42, 54);  // the demonstration of the PCG library [O'Neill 2014]
  for (const std::uint32_t expected :
       {0xa15c02b7u, 0x7b47f409u, 0xba1d3330u, 0x83d2f293u, 0xbfa4784bu, 0xcbed606eu})
    CHECK(rng.next_u32() == expected);
}

TEST_CASE("Equal seeds repeat and streams differ") {
  Rng a(7, 1), b(7, 1), c(7, 2);
  int equal = 0;
  for (int i = 0; i < 100; ++i) {
    const std::uint32_t value = a.next_u32();
    CHECK(b.next_u32() == value);
    equal += c.next_u32() == value ? 1 : 0;
  }
  CHECK(equal == 0);
}

TEST_CASE("Uniform numbers fill the unit interval evenly") {
  Rng rng(1);
  constexpr int kDraws = 100'000, kBins = 10;
  std::array<int, kBins> bins{};
  for (int i = 0; i < kDraws; ++i) {
    const float value = rng.uniform();
    REQUIRE((value >= 0.0f && value < 1.0f));
    ++bins[static_cast<std::size_t>(value * kBins)];
  }
  // Chi square with 9 degrees of freedom: 27.9 is exceeded once in a thousand.
  double chi2 = 0;
  for (const int count : bins) chi2 += (count - 1e4) * (count - 1e4) / 1e4;
  CHECK(chi2 < 27.9);
}

TEST_CASE("Integers below a bound reach every value and never the bound") {
  Rng rng(2);
  std::array<int, 7> seen{};
  for (int i = 0; i < 7000; ++i) {
    const std::uint32_t value = rng.below(7);
    REQUIRE(value < 7);
    ++seen[value];
  }
  for (const int count : seen) CHECK(count == Approx(1000).margin(150));  // 5 standard deviations
  CHECK(rng.below(1) == 0);
}

TEST_CASE("Normal numbers have zero mean, unit variance and no skew") {
  Rng rng(3);
  constexpr int kDraws = 100'000;
  double sum = 0, sum2 = 0, sum3 = 0;
  for (int i = 0; i < kDraws; ++i) {
    const auto value = static_cast<double>(rng.normal());
    REQUIRE(std::isfinite(value));
    sum += value;
    sum2 += value * value;
    sum3 += value * value * value;
  }
  // Four standard errors: 1, sqrt(2) and sqrt(15) over sqrt(n).
  CHECK(sum / kDraws == Approx(0).margin(0.0127));
  CHECK(sum2 / kDraws == Approx(1).margin(0.018));
  CHECK(sum3 / kDraws == Approx(0).margin(0.049));
}

TEST_CASE("Names hash to the FNV-1a values") {
  CHECK(hash_name("") == 0xcbf29ce484222325ull);
  CHECK(hash_name("a") == 0xaf63dc4c8601ec8cull);
  CHECK(hash_name("foobar") == 0x85944171f73967e8ull);
}
