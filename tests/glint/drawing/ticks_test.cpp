// SPDX-License-Identifier: MIT
#include "glint/drawing/ticks.h"

#include <catch2/catch.hpp>

using namespace glint;
using Labels = std::vector<std::string>;

TEST_CASE("ticks are round numbers within the limits") {
  CHECK(round_ticks(0, 10) == std::vector<double>{0, 2, 4, 6, 8, 10});
  CHECK(round_ticks(17.2, 24.9) == std::vector<double>{18, 20, 22, 24});
  CHECK(round_ticks(-1, 1.5) == std::vector<double>{-1, -0.5, 0, 0.5, 1, 1.5});
  CHECK(round_ticks(1000, 60000) == std::vector<double>{10000, 20000, 30000, 40000, 50000, 60000});
  CHECK(round_ticks(-0.5, 10.5) == std::vector<double>{0, 2, 4, 6, 8, 10});
}

TEST_CASE("there are two to seven ticks, whatever the range") {
  for (double size = 1e-3; size < 1e7; size *= 1.37)
    for (const double low : {0.0, -0.3 * size, 5.1 * size}) {
      const auto ticks = round_ticks(low, low + size);
      INFO(low << " " << size);
      CHECK(ticks.size() >= 2);
      CHECK(ticks.size() <= 7);
      CHECK(ticks.front() >= low);
      CHECK(ticks.back() <= low + size);
    }
}

TEST_CASE("ticks of logarithms are powers of ten, or a few more where there are few of them") {
  CHECK(log_ticks(900, 1.2e6) == std::vector<double>{1000, 10000, 100000, 1000000});
  CHECK(log_ticks(8, 60) == std::vector<double>{10, 20, 50});
  CHECK(log_ticks(1, 10) == std::vector<double>{1, 2, 5, 10});
  CHECK(log_ticks(2620, 3300) == round_ticks(2620, 3300));  // narrow: round numbers
  const std::vector<double> small = log_ticks(0.0009, 0.3);
  REQUIRE(small.size() == 3);
  CHECK(small[0] == Approx(0.001));
}

TEST_CASE("labels of an axis have the same decimals") {
  CHECK(tick_labels({0, 0.5, 1, 1.5}) == Labels{"0.0", "0.5", "1.0", "1.5"});
  CHECK(tick_labels({18, 20, 22}) == Labels{"18", "20", "22"});
  CHECK(tick_labels({-0.02, 0, 0.02}) == Labels{"−0.02", "0.00", "0.02"});
  CHECK(tick_labels(round_ticks(0, 0.31)) == Labels{"0.0", "0.1", "0.2", "0.3"});
  CHECK(tick_labels({}).empty());
}

TEST_CASE("large numbers are written in thousands and millions") {
  CHECK(tick_labels({0, 2000, 4000}) == Labels{"0", "2000", "4000"});
  CHECK(tick_labels({0, 10000, 20000}) == Labels{"0", "10k", "20k"});
  CHECK(tick_labels({5000, 7500, 10000}) == Labels{"5.0k", "7.5k", "10.0k"});
  CHECK(tick_labels({0, 2e7}) == Labels{"0", "20M"});
}
