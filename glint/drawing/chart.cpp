// SPDX-License-Identifier: MIT
#include "glint/drawing/chart.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "glint/drawing/ticks.h"

namespace glint {

namespace {

constexpr double kTop = 4, kRight = 4;           // points around the axes
constexpr double kTickGap = 2.5, kLabelGap = 3;  // between axis, its numbers and its words
constexpr Color kGrid{0.88, 0.88, 0.88}, kFrame{0.45, 0.45, 0.45};
constexpr std::size_t kFewPoints = 16;  // a line of so many has dots
const TextStyle kNumber{6.5}, kWords{7};

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

bool is_logarithmic(const Chart& chart, bool x) {
  return chart.logarithmic || (!x && chart.logarithmic_y);
}

bool is_point(const Chart& chart, const ChartSeries& series, std::size_t i) {
  const double x = series.x[i], y = series.y[i];
  return std::isfinite(x) && std::isfinite(y) && (x > 0 || !is_logarithmic(chart, true)) &&
         (y > 0 || !is_logarithmic(chart, false));
}

bool has_points(const Chart& chart, const ChartSeries& series) {
  for (std::size_t i = 0; i < series.x.size(); ++i)
    if (is_point(chart, series, i)) return true;
  return false;
}

struct Axis {
  Range range;  // of places
  std::vector<double> ticks;
  std::vector<std::string> labels;
  bool logarithmic = false;

  double place(double value) const { return logarithmic ? std::log10(value) : value; }
  // From 0 at the low end to 1.
  double share(double value) const { return (place(value) - range.low) / (range.high - range.low); }
};

// Each with the decimals that it needs itself.
std::vector<std::string> log_labels(const std::vector<double>& ticks) {
  std::vector<std::string> labels;
  for (const double tick : ticks) labels.push_back(tick_labels({tick}).front());
  return labels;
}

Axis axis_of(const Chart& chart, std::vector<double> ChartSeries::*values) {
  Axis axis;
  axis.logarithmic = is_logarithmic(chart, values == &ChartSeries::x);
  for (const ChartSeries& series : chart.series)
    for (std::size_t i = 0; i < series.x.size(); ++i)
      if (is_point(chart, series, i)) axis.range.add(axis.place((series.*values)[i]));
  axis.range = with_room(axis.range);
  const double low = axis.range.low, high = axis.range.high;
  axis.ticks =
      axis.logarithmic ? log_ticks(std::pow(10, low), std::pow(10, high)) : round_ticks(low, high);
  axis.labels = axis.logarithmic ? log_labels(axis.ticks) : tick_labels(axis.ticks);
  return axis;
}

class ChartDrawing {
 public:
  ChartDrawing(Canvas& canvas, const Box& box, const Chart& chart)
      : canvas_(canvas),
        box_(box),
        chart_(chart),
        x_(axis_of(chart, &ChartSeries::x)),
        y_(axis_of(chart, &ChartSeries::y)) {
    const double words = measure_text(chart.x_label, kWords).height + kLabelGap;
    const double numbers = measure_text("0", kNumber).height + kTickGap;
    const double left = words + widest_number() + kTickGap;
    field_ = {
        box.left + left,
        box.top + kTop,
        box.width - left - kRight,
        box.height - kTop - numbers - words};
  }

  void draw() {
    draw_grid();
    for (const ChartSeries& series : chart_.series) draw_series(series);
    draw_numbers();
    draw_words();
  }

 private:
  double widest_number() const {
    double widest = 0;
    for (const std::string& label : y_.labels)
      widest = std::max(widest, measure_text(label, kNumber).width);
    return widest;
  }

  // Of a number below the axis: beneath its tick, but not beyond the box.
  double label_middle(std::size_t i) const {
    const double half = measure_text(x_.labels[i], kNumber).width / 2;
    return std::min(column(x_.ticks[i]), box_.right() - half);
  }
  double column(double x) const { return field_.left + x_.share(x) * field_.width; }
  double row(double y) const { return field_.bottom() - y_.share(y) * field_.height; }

  void draw_grid() {
    const auto line = [&](Point from, Point to) {
      const Point points[] = {from, to};
      canvas_.line(points, {kGrid, 0.4, {}});
    };
    for (const double x : x_.ticks) line({column(x), field_.top}, {column(x), field_.bottom()});
    for (const double y : y_.ticks) line({field_.left, row(y)}, {field_.right(), row(y)});
    canvas_.rectangle(field_, {kFrame, 0.5, {}});
  }

  void draw_series(const ChartSeries& series) {
    const SeriesStyle style = series_style(series.index);
    std::vector<Point> piece;
    const auto end_piece = [&] {
      if (piece.size() > 1) draw_series_line(canvas_, piece, style);
      piece.clear();
    };
    for (std::size_t i = 0; i < series.x.size() && !series.points; ++i)
      if (is_point(chart_, series, i))
        piece.push_back({column(series.x[i]), row(series.y[i])});
      else
        end_piece();
    end_piece();
    if (!has_dots(series)) return;
    for (std::size_t i = 0; i < series.x.size(); ++i)
      if (is_point(chart_, series, i))
        draw_series_dot(canvas_, {column(series.x[i]), row(series.y[i])}, style);
  }

  void draw_numbers() {
    TextStyle style = kNumber;
    style.align = Align::kCenter;
    for (std::size_t i = 0; i < x_.ticks.size(); ++i)
      canvas_.text(x_.labels[i], {label_middle(i), field_.bottom() + kTickGap}, style);
    style.align = Align::kRight;
    const double middle = measure_text("0", kNumber).height / 2;
    for (std::size_t i = 0; i < y_.ticks.size(); ++i)
      canvas_.text(y_.labels[i], {field_.left - kTickGap, row(y_.ticks[i]) - middle}, style);
  }

  void draw_words() {
    TextStyle style = kWords;
    style.align = Align::kCenter;
    const double height = measure_text(chart_.x_label, style).height;
    canvas_.text(chart_.x_label, {field_.left + field_.width / 2, box_.bottom() - height}, style);
    canvas_.text_upwards(chart_.y_label, {box_.left, field_.top + field_.height / 2}, style);
  }

  Canvas& canvas_;
  const Box& box_;
  const Chart& chart_;
  Axis x_, y_;
  Box field_;  // within the axes
};

}  // namespace

bool has_points(const Chart& chart) {
  return std::any_of(chart.series.begin(), chart.series.end(), [&](const ChartSeries& series) {
    return has_points(chart, series);
  });
}

bool has_dots(const ChartSeries& series) { return series.points || series.x.size() <= kFewPoints; }

void draw_chart(Canvas& canvas, const Box& box, const Chart& chart) {
  ChartDrawing(canvas, box, chart).draw();
}

}  // namespace glint
