// SPDX-License-Identifier: MIT
#include "glint/drawing/chart.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace glint;

namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();

ChartSheet sheet_of(const ChartSeries& series, const std::string& name = "name") {
  ChartSheet sheet;
  sheet.names.assign(series.index + 1, name);
  sheet.rows.push_back({"", {{"x", "y", {series}}}});
  return sheet;
}

Image drawn(const ChartSeries& series) { return draw_image(draw_charts(sheet_of(series))); }

// Pixels of about the colour of the first series.
int count_blue(const Image& picture) {
  int count = 0;
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x)
      count += picture.at(x, y, 0) < 0.02f && std::abs(picture.at(x, y, 1) - 114 / 255.0f) < 0.01f;
  return count;
}

int count_differing(const Image& a, const Image& b) {
  REQUIRE(a.size() == b.size());
  int count = 0;
  for (std::size_t i = 0; i < a.values().size(); ++i)
    count += std::abs(a.values()[i] - b.values()[i]) > 0.1f;
  return count;
}

Image grey(const Image& color) {
  Image result(color.width(), color.height(), 1);
  for (int y = 0; y < color.height(); ++y)
    for (int x = 0; x < color.width(); ++x)
      result.at(x, y) =
          0.2126f * color.at(x, y, 0) + 0.7152f * color.at(x, y, 1) + 0.0722f * color.at(x, y, 2);
  return result;
}

}  // namespace

TEST_CASE("on axes of logarithms, factors are distances, and nothing lies at or below 0") {
  const auto sheet = [](const ChartSeries& series) {
    ChartSheet log = sheet_of(series);
    log.rows[0].charts[0].logarithmic = true;
    return log;
  };
  CHECK(draw_charts(sheet({0, {-1, 0, 1}, {1, 1, 0}})).empty());
  // The same dots for the same factors; numbers under the axis differ.
  const Image a = draw_image(draw_charts(sheet({0, {1, 10, 1000}, {1, 10, 100}, true})));
  const Image b = draw_image(draw_charts(sheet({0, {2, 20, 2000}, {1, 10, 100}, true})));
  const Image with_zero =
      draw_image(draw_charts(sheet({0, {1, 10, 1000, 0}, {1, 10, 100, 50}, true})));
  REQUIRE(a.size() == b.size());
  CHECK(count_blue(a) > 0);
  for (int y = 0; y < a.height() / 2; ++y)
    for (int x = 0; x < a.width(); ++x) {
      const bool blue = a.at(x, y, 0) < 0.02f && a.at(x, y, 2) > 0.5f;
      if (blue) CHECK(b.at(x, y, 0) < 0.1f);
    }
  CHECK(count_differing(a, with_zero) == 0);
}

TEST_CASE("a sheet without a finite point is empty, rows without one are left out") {
  CHECK(draw_charts({}).empty());
  CHECK(draw_charts(sheet_of({0, {1, kNan}, {kNan, 2}})).empty());
  ChartSheet sheet = sheet_of({0, {1, 2}, {1, 2}});
  const double height = draw_charts(sheet).height;
  sheet.rows.push_back({"nothing", {{"x", "y", {{0, {kNan}, {1}}}}}});
  CHECK(draw_charts(sheet).height == height);
}

TEST_CASE("lines join neighbours and leave gaps where there is no value") {
  const auto ink_with_gap = [](int begin, int end) {
    ChartSeries series{0, {}, {}};
    for (int i = 0; i <= 200; ++i) {
      series.x.push_back(i);
      series.y.push_back(i > begin && i < end ? kNan : 1.0);
    }
    return count_blue(drawn(series));
  };
  const int all = ink_with_gap(0, 0), half = ink_with_gap(50, 150), quarter = ink_with_gap(25, 175);
  CHECK(all - half > 500);
  CHECK(all - half == Approx(2 * (half - quarter)).epsilon(0.02));
}

TEST_CASE("a line of few points has a dot at each") {
  const ChartSeries few{0, {0, 1, 2}, {1, 1, 1}};
  ChartSeries many{0, {}, {}};
  for (int i = 0; i <= 100; ++i) {
    many.x.push_back(i / 50.0);
    many.y.push_back(1);
  }
  CHECK(count_blue(drawn(few)) > count_blue(drawn(many)) + 100);
}

TEST_CASE("a single dot has room around it") {
  const ChartSheet sheet = sheet_of({0, {5}, {30}, true});
  const Drawing drawing = draw_charts(sheet);
  CHECK(count_blue(draw_image(drawing)) > 100);
  CHECK(drawing.width == Approx(sheet.chart_width).margin(5));
  CHECK(drawing.height < drawing.width);
}

TEST_CASE("32 series differ in colour or pattern, as lines and as dots") {
  std::vector<Image> lines, dots;
  for (std::size_t index = 0; index < 32; ++index) {
    lines.push_back(drawn({index, {0, 1, 2}, {0, 2, 1}}));
    dots.push_back(drawn({index, {0, 1, 2}, {0, 2, 1}, true}));
  }
  for (std::size_t i = 0; i < 32; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      CHECK(count_differing(lines[i], lines[j]) > 1000);
      CHECK(count_differing(dots[i], dots[j]) > 100);
    }
  CHECK(series_style(32).color == series_style(0).color);
  CHECK(series_style(32).pattern == series_style(0).pattern);
}

TEST_CASE("grey print tells the first eight series apart") {
  std::vector<Image> lines;
  for (std::size_t index = 0; index < 8; ++index)
    lines.push_back(grey(drawn({index, {0, 1, 2}, {0, 2, 1}})));
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      INFO(i << " " << j);
      CHECK(count_differing(lines[i], lines[j]) > 1000);
    }
}

TEST_CASE("a dashed line has gaps, on short pieces as on long ones") {
  const auto ink = [](std::size_t index, int pieces) {
    ChartSeries series{index, {}, {}};
    for (int i = 0; i <= pieces; ++i) {
      series.x.push_back(static_cast<double>(i) / pieces);
      series.y.push_back(static_cast<double>(i) / pieces);
    }
    return count_blue(drawn(series));
  };
  REQUIRE(series_style(8).color == 0);
  REQUIRE(series_style(8).pattern == 1);
  for (const int pieces : {40, 400}) {
    CHECK(ink(8, pieces) < 0.85 * ink(0, pieces));
    CHECK(ink(8, pieces) > 0.4 * ink(0, pieces));
  }
}

TEST_CASE("the legend names the series that are drawn, in as many lines as they need") {
  ChartSheet sheet = sheet_of({0, {1, 2}, {1, 2}});
  const double one = draw_charts(sheet).height;
  sheet.names = {"2DGS", "drawn nowhere"};
  CHECK(draw_charts(sheet).height == one);
  for (std::size_t index = 1; index < 6; ++index) {
    sheet.names.resize(index + 1, "a rather long name, so that two fit a line at most");
    sheet.rows[0].charts[0].series.push_back({index, {1, 2}, {2, 1}});
  }
  sheet.names[1] = sheet.names[2];
  CHECK(draw_charts(sheet).height > one + 30);
}

TEST_CASE("titles of columns and of rows have lines of their own") {
  ChartSheet sheet = sheet_of({0, {1, 2}, {1, 2}});
  const double plain = draw_charts(sheet).height;
  sheet.rows[0].title = "room_1";
  const double row = draw_charts(sheet).height;
  CHECK(row > plain + 5);
  sheet.titles = {"training", "quality"};
  CHECK(draw_charts(sheet).height > row + 5);
  CHECK(draw_charts(sheet).width > 2 * sheet.chart_width);
}
