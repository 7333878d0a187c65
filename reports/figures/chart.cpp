// SPDX-License-Identifier: MIT
#include "reports/figures/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "glint/scene/image_files.h"

namespace glint {

namespace {

constexpr int kLeft = 52, kRight = 24, kTop = 22, kBottom = 40;  // margins around the axes
constexpr int kLetter = 9, kLegendLine = 17;
constexpr std::array<std::array<int, 3>, 8> kColors{{
    {0, 114, 178},
    {213, 94, 0},
    {0, 158, 115},
    {204, 121, 167},
    {230, 159, 0},
    {86, 180, 233},
    {0, 0, 0},
    {150, 130, 0},
}};

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

// A twentieth of room to either side; a single value gets room, too.
Range with_room(Range range) {
  const double size = range.high - range.low;
  const double room = size > 0 ? size / 20 : std::max(std::abs(range.low) / 10, 1e-6);
  return {range.low - room, range.high + room};
}

class ChartDrawing {
 public:
  ChartDrawing(const Chart& chart, Range x, Range y)
      : chart_(chart),
        x_(with_room(x)),
        y_(with_room(y)),
        canvas_(
            kChartHeight + kLegendLine * static_cast<int>(chart.series.size()),
            kChartWidth,
            CV_8UC3,
            cv::Scalar::all(255)
        ) {}

  Image draw() {
    draw_axes();
    for (std::size_t i = 0; i < chart_.series.size(); ++i) draw_series(i);
    Image picture(canvas_.cols, canvas_.rows, 3);
    std::transform(  // a new canvas has its rows one behind the other
        canvas_.data,
        canvas_.data + picture.values().size(),
        picture.values().begin(),
        [](unsigned char value) { return static_cast<float>(value) / 255; }
    );
    draw_words(picture);
    return picture;
  }

 private:
  double column(double x) const {
    return kLeft + (x - x_.low) / (x_.high - x_.low) * (kChartWidth - kLeft - kRight);
  }
  double row(double y) const {
    return kChartHeight - kBottom -
           (y - y_.low) / (y_.high - y_.low) * (kChartHeight - kTop - kBottom);
  }

  static cv::Point pixel(double x, double y) {
    return {static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y))};
  }

  void draw_axes() {
    const cv::Scalar grid = cv::Scalar::all(225), frame = cv::Scalar::all(120);
    for (const double x : round_ticks(x_.low, x_.high))
      cv::line(canvas_, pixel(column(x), kTop), pixel(column(x), kChartHeight - kBottom), grid);
    for (const double y : round_ticks(y_.low, y_.high))
      cv::line(canvas_, pixel(kLeft, row(y)), pixel(kChartWidth - kRight, row(y)), grid);
    cv::rectangle(
        canvas_, pixel(kLeft, kTop), pixel(kChartWidth - kRight, kChartHeight - kBottom), frame
    );
  }

  void draw_series(std::size_t index) {
    const ChartSeries& series = chart_.series[index];
    const auto& color = kColors[index % kColors.size()];
    const cv::Scalar ink(color[0], color[1], color[2]);
    const bool first_round = index < kColors.size();
    const int width = first_round ? 2 : 1, radius = first_round ? 5 : 3;
    cv::Point last;
    bool joined = false;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      const bool finite = std::isfinite(series.x[i]) && std::isfinite(series.y[i]);
      if (finite) {
        const cv::Point point = pixel(column(series.x[i]), row(series.y[i]));
        if (series.points) cv::circle(canvas_, point, radius, ink, cv::FILLED, cv::LINE_AA);
        if (!series.points && joined) cv::line(canvas_, last, point, ink, width, cv::LINE_AA);
        last = point;
      }
      joined = finite;
    }
    const int middle = legend_row(index) - kLetter / 2;
    cv::line(canvas_, {kLeft, middle}, {kLeft + 20, middle}, ink, 2 * width, cv::LINE_AA);
  }

  static int legend_row(std::size_t index) {
    return kChartHeight + kLegendLine * static_cast<int>(index) + kLetter + 2;
  }

  void draw_words(Image& picture) const {
    const auto centred = [&](const std::string& text, double middle, int baseline) {
      const int left = static_cast<int>(middle) - text_width(text, kLetter) / 2;
      draw_text(picture, text, left, baseline, kLetter);
    };
    for (const double x : round_ticks(x_.low, x_.high))
      centred(fmt::format("{:g}", x), column(x), kChartHeight - kBottom + kLetter + 5);
    for (const double y : round_ticks(y_.low, y_.high)) {
      const std::string text = fmt::format("{:g}", y);
      const int baseline = static_cast<int>(row(y)) + kLetter / 2;
      draw_text(picture, text, kLeft - 5 - text_width(text, kLetter), baseline, kLetter);
    }
    centred(chart_.x_label, (kLeft + kChartWidth - kRight) / 2.0, kChartHeight - 8);
    draw_text(picture, chart_.y_label, 4, kLetter + 4, kLetter);
    for (std::size_t i = 0; i < chart_.series.size(); ++i)
      draw_text(picture, chart_.series[i].name, kLeft + 28, legend_row(i), kLetter);
  }

  const Chart& chart_;
  Range x_, y_;
  cv::Mat canvas_;
};

}  // namespace

std::vector<double> round_ticks(double low, double high) {
  const double rough = (high - low) / 5, power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0})
    if (factor * power >= rough) step = factor * power;
  std::vector<double> ticks;
  for (double tick = std::ceil(low / step); tick * step <= high; ++tick)
    ticks.push_back(tick == 0 ? 0 : tick * step);
  return ticks;
}

Image draw_chart(const Chart& chart) {
  Range x, y;
  for (const ChartSeries& series : chart.series)
    for (std::size_t i = 0; i < series.x.size(); ++i)
      if (std::isfinite(series.x[i]) && std::isfinite(series.y[i])) {
        x.add(series.x[i]);
        y.add(series.y[i]);
      }
  if (x.low > x.high) return {};
  return ChartDrawing(chart, x, y).draw();
}

}  // namespace glint
