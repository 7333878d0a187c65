// SPDX-License-Identifier: MIT
#include "reports/figures/chart.h"

#include <catch2/catch.hpp>

#include <limits>

using namespace glint;

namespace {

// Pixels of about this colour inside the axes.
int count_color(const Image& picture, float red, float green, float blue) {
  int count = 0;
  for (int y = 0; y < kChartHeight; ++y)
    for (int x = 0; x < picture.width(); ++x)
      count += std::abs(picture.at(x, y, 0) - red) < 0.01f &&
               std::abs(picture.at(x, y, 1) - green) < 0.01f &&
               std::abs(picture.at(x, y, 2) - blue) < 0.01f;
  return count;
}

}  // namespace

TEST_CASE("ticks are round numbers within the limits") {
  CHECK(round_ticks(0, 10) == std::vector<double>{0, 2, 4, 6, 8, 10});
  CHECK(round_ticks(17.2, 24.9) == std::vector<double>{18, 20, 22, 24});
  CHECK(round_ticks(-1, 1.5) == std::vector<double>{-1, -0.5, 0, 0.5, 1, 1.5});
  CHECK(round_ticks(1000, 60000).front() == 20000);
}

TEST_CASE("a chart without a finite point is empty") {
  CHECK(draw_chart({"x", "y", {}}).empty());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(draw_chart({"x", "y", {{"a", {1, nan}, {nan, 2}}}}).empty());
}

TEST_CASE("lines join neighbours and leave gaps where there is no value") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Image whole = draw_chart({"x", "y", {{"a", {0, 1, 2, 3}, {1, 1, 1, 1}}}});
  const Image gap = draw_chart({"x", "y", {{"a", {0, 1, 2, 3}, {1, 1, nan, 1}}}});
  const int all = count_color(whole, 0, 114 / 255.0f, 178 / 255.0f);
  const int left = count_color(gap, 0, 114 / 255.0f, 178 / 255.0f);
  CHECK(all > 300);
  CHECK(left > all / 4);
  CHECK(left < all / 2);
}

TEST_CASE("a single dot has room around it, each series a line of the legend") {
  ChartSeries dot{"a", {5}, {30}, true};
  const Image one = draw_chart({"x", "y", {dot}});
  CHECK(count_color(one, 0, 114 / 255.0f, 178 / 255.0f) > 40);
  CHECK(one.width() == kChartWidth);
  const Image two = draw_chart({"x", "y", {dot, dot}});
  CHECK(two.height() > one.height());
}
