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

int count_differing(const Image& a, const Image& b) {
  int count = 0;
  for (std::size_t i = 0; i < a.values().size(); ++i)
    count += std::abs(a.values()[i] - b.values()[i]) > 0.1f;
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
  CHECK(draw_chart({"x", "y", {{0, {1, nan}, {nan, 2}}}}).empty());
}

TEST_CASE("lines join neighbours and leave gaps where there is no value") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Image whole = draw_chart({"x", "y", {{0, {0, 1, 2, 3}, {1, 1, 1, 1}}}});
  const Image gap = draw_chart({"x", "y", {{0, {0, 1, 2, 3}, {1, 1, nan, 1}}}});
  const int all = count_color(whole, 0, 114 / 255.0f, 178 / 255.0f);
  const int left = count_color(gap, 0, 114 / 255.0f, 178 / 255.0f);
  CHECK(all > 300);
  CHECK(left > all / 4);
  CHECK(left < all / 2);
}

TEST_CASE("a single dot has room around it") {
  const Image one = draw_chart({"x", "y", {{0, {5}, {30}, true}}});
  CHECK(count_color(one, 0, 114 / 255.0f, 178 / 255.0f) > 40);
  CHECK(one.width() == kChartWidth);
  CHECK(one.height() == kChartHeight);
}

TEST_CASE("32 series differ in colour or pattern, as lines and as dots") {
  std::vector<Image> lines, dots;
  for (std::size_t index = 0; index < 32; ++index) {
    lines.push_back(draw_chart({"x", "y", {{index, {0, 1, 2}, {0, 2, 1}}}}));
    dots.push_back(draw_chart({"x", "y", {{index, {0, 1, 2}, {0, 2, 1}, true}}}));
  }
  for (std::size_t i = 0; i < 32; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      CHECK(count_differing(lines[i], lines[j]) > 100);
      CHECK(count_differing(dots[i], dots[j]) > 20);
    }
  CHECK(series_style(32).color == series_style(0).color);
  CHECK(series_style(32).pattern == series_style(0).pattern);
}

TEST_CASE("a dashed line has gaps, on short pieces as on long ones") {
  ChartSeries whole{0, {0, 1}, {0, 1}}, dashed{8, {0, 1}, {0, 1}}, pieces{8, {}, {}};
  for (int i = 0; i <= 100; ++i) {
    pieces.x.push_back(i / 100.0);
    pieces.y.push_back(i / 100.0);
  }
  const auto ink = [](const ChartSeries& series) {
    return count_color(draw_chart({"x", "y", {series}}), 0, 114 / 255.0f, 178 / 255.0f);
  };
  CHECK(ink(dashed) < 0.85 * ink(whole));
  CHECK(ink(dashed) > 0.4 * ink(whole));
  CHECK(ink(pieces) < 0.85 * ink(whole));
  CHECK(ink(pieces) > 0.4 * ink(whole));
}

TEST_CASE("the legend deals names to panels down first") {
  const auto height = [](const std::vector<Image>& panels, std::size_t i) {
    return panels.at(i).height();
  };
  const auto five = draw_chart_legend({"a", "b", "c", "d", "e"}, 3);
  REQUIRE(five.size() == 3);
  CHECK(height(five, 0) == height(five, 1));
  CHECK(height(five, 0) == 2 * height(five, 2));
  CHECK(five[0].width() == kChartWidth);
  CHECK(draw_chart_legend({"a"}, 3).size() == 1);
  CHECK(draw_chart_legend({}, 3).empty());
}
