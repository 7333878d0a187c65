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
constexpr int kLetter = 9, kLegendLine = 20;
constexpr int kLine = 2, kDot = 5;  // width of a line, radius of a dot
constexpr int kSample = 44;         // length of a line in the legend
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

constexpr std::size_t kPatterns = 4;
// Drawn and left out in turn, pixels; the first is one line without gaps.
const std::array<std::vector<double>, kPatterns> kDashes{{{1e9}, {9, 6}, {2, 5}, {12, 5, 2, 5}}};
// Corners of the second to fourth shape of a dot: square, triangle, diamond.
const std::array<std::vector<std::array<int, 2>>, kPatterns - 1> kOutlines{
    {{{-4, -4}, {4, -4}, {4, 4}, {-4, 4}},
     {{0, -6}, {6, 4}, {-6, 4}},
     {{0, -6}, {6, 0}, {0, 6}, {-6, 0}}}};

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

using Canvas = cv::Mat;

Canvas white_canvas(int width, int height) {
  return Canvas(height, width, CV_8UC3, cv::Scalar::all(255));
}

Image picture_of(const Canvas& canvas) {
  Image picture(canvas.cols, canvas.rows, 3);
  std::transform(  // a new canvas has its rows one behind the other
      canvas.data,
      canvas.data + picture.values().size(),
      picture.values().begin(),
      [](unsigned char value) { return static_cast<float>(value) / 255; }
  );
  return picture;
}

cv::Point pixel(double x, double y) {
  return {static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y))};
}

// Draws the lines and dots of one series.
class Pen {
 public:
  Pen(Canvas& canvas, std::size_t index) : canvas_(canvas), style_(series_style(index)) {
    const auto& color = kColors[static_cast<std::size_t>(style_.color)];
    ink_ = cv::Scalar(color[0], color[1], color[2]);
  }

  void lift() { down_ = false; }

  // From the last place, unless the pen was lifted; its pattern goes on around corners.
  void line_to(cv::Point2d to) {
    if (down_) draw_line(last_, to);
    last_ = to;
    down_ = true;
  }

  void dot(cv::Point2d at) {
    const cv::Point center = pixel(at.x, at.y);
    if (style_.pattern == 0)
      return cv::circle(canvas_, center, kDot, ink_, cv::FILLED, cv::LINE_AA);
    std::vector<cv::Point> outline;
    for (const auto& corner : kOutlines[static_cast<std::size_t>(style_.pattern) - 1])
      outline.push_back(center + cv::Point(corner[0], corner[1]));
    cv::fillConvexPoly(canvas_, outline, ink_, cv::LINE_AA);
  }

 private:
  void draw_line(cv::Point2d from, cv::Point2d to) {
    const double length = cv::norm(to - from);
    const auto& dashes = kDashes[static_cast<std::size_t>(style_.pattern)];
    for (double at = 0; at < length;) {
      const double piece = std::min(length - at, dashes[dash_] - drawn_);
      const cv::Point2d a = from + at / length * (to - from);
      const cv::Point2d b = from + (at + piece) / length * (to - from);
      if (dash_ % 2 == 0)
        cv::line(canvas_, pixel(a.x, a.y), pixel(b.x, b.y), ink_, kLine, cv::LINE_AA);
      at += piece;
      drawn_ += piece;
      if (drawn_ < dashes[dash_]) return;
      dash_ = (dash_ + 1) % dashes.size();
      drawn_ = 0;
    }
  }

  Canvas& canvas_;
  SeriesStyle style_;
  cv::Scalar ink_;
  cv::Point2d last_;
  bool down_ = false;
  std::size_t dash_ = 0;
  double drawn_ = 0;  // of the current dash, pixels
};

class ChartDrawing {
 public:
  ChartDrawing(const Chart& chart, Range x, Range y)
      : chart_(chart),
        x_(with_room(x)),
        y_(with_room(y)),
        canvas_(white_canvas(kChartWidth, kChartHeight)) {}

  Image draw() {
    draw_axes();
    for (const ChartSeries& series : chart_.series) draw_series(series);
    Image picture = picture_of(canvas_);
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

  void draw_series(const ChartSeries& series) {
    Pen pen(canvas_, series.index);
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (!std::isfinite(series.x[i]) || !std::isfinite(series.y[i])) {
        pen.lift();
        continue;
      }
      const cv::Point2d at(column(series.x[i]), row(series.y[i]));
      if (series.points)
        pen.dot(at);
      else
        pen.line_to(at);
    }
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
  }

  const Chart& chart_;
  Range x_, y_;
  Canvas canvas_;
};

// The names [begin, end), one below the other.
Image legend_panel(const std::vector<std::string>& names, std::size_t begin, std::size_t end) {
  const auto baseline = [&](std::size_t i) {
    return kLegendLine * static_cast<int>(i - begin + 1) - (kLegendLine - kLetter) / 2;
  };
  Canvas canvas = white_canvas(kChartWidth, kLegendLine * static_cast<int>(end - begin));
  for (std::size_t i = begin; i < end; ++i) {
    Pen pen(canvas, i);
    const double middle = baseline(i) - kLetter / 2;
    pen.line_to({4.0, middle});
    pen.line_to({4.0 + kSample, middle});
    pen.dot({4.0 + kSample + 14, middle});
  }
  Image picture = picture_of(canvas);
  for (std::size_t i = begin; i < end; ++i)
    draw_text(picture, names[i], kSample + 30, baseline(i), kLetter);
  return picture;
}

}  // namespace

SeriesStyle series_style(std::size_t index) {
  return {
      static_cast<int>(index % kColors.size()),
      static_cast<int>(index / kColors.size() % kPatterns)};
}

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

std::vector<Image> draw_chart_legend(
    const std::vector<std::string>& names, std::size_t num_panels
) {
  const std::size_t each = (names.size() + num_panels - 1) / num_panels;
  std::vector<Image> panels;
  for (std::size_t begin = 0; begin < names.size(); begin += each)
    panels.push_back(legend_panel(names, begin, std::min(begin + each, names.size())));
  return panels;
}

}  // namespace glint
