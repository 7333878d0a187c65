// SPDX-License-Identifier: MIT
// Rows of charts with their titles and one legend.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "glint/drawing/chart.h"

namespace glint {

namespace {

constexpr double kMargin = 2;  // points around everything
constexpr double kColumnGap = 10, kRowGap = 8;
constexpr double kHeightOfWidth = 0.72;         // of a chart
constexpr double kSample = 20, kSampleGap = 4;  // length of a line in the legend, room behind it
constexpr double kEntryGap = 12;
const TextStyle kTitle{7.5, true, Align::kCenter}, kRowTitle{7.5, true}, kName{7};

bool has_points(const ChartRow& row) {
  return std::any_of(row.charts.begin(), row.charts.end(), [](const Chart& chart) {
    return has_points(chart);
  });
}

// How a series is drawn in any of the charts.
struct Entry {
  bool line = false, dots = false;
};

// By index; without those that have no point.
std::map<std::size_t, Entry> entries_of(const ChartSheet& sheet) {
  std::map<std::size_t, Entry> entries;
  for (const ChartRow& row : sheet.rows)
    for (const Chart& chart : row.charts)
      for (const ChartSeries& series : chart.series)
        if (has_points(Chart{"", "", {series}})) {
          entries[series.index].line |= !series.points;
          entries[series.index].dots |= has_dots(series);
        }
  return entries;
}

// Entries in columns of one width, read down first.
struct Legend {
  std::map<std::size_t, Entry> entries;
  double width = 0, height = 0;  // of an entry, points
  std::size_t columns = 1, lines = 0;
};

Legend legend_of(const ChartSheet& sheet, double width) {
  Legend legend;
  legend.entries = entries_of(sheet);
  double name = 0;
  for (const auto& [index, entry] : legend.entries)
    name = std::max(name, measure_text(sheet.names[index], kName).width);
  legend.width = kSample + kSampleGap + name + kEntryGap;
  legend.height = 1.25 * measure_text("0", kName).height;
  const std::size_t count = legend.entries.size();
  const double fit = std::floor((width + kEntryGap) / legend.width);
  const auto most = static_cast<std::size_t>(std::max(1.0, fit));
  legend.lines = (count + most - 1) / most;
  legend.columns = (count + legend.lines - 1) / legend.lines;
  return legend;
}

class SheetDrawing {
 public:
  explicit SheetDrawing(const ChartSheet& sheet) : sheet_(sheet) {
    std::erase_if(sheet_.rows, [](const ChartRow& row) { return !has_points(row); });
    std::size_t columns = sheet_.titles.size();
    for (const ChartRow& row : sheet_.rows) columns = std::max(columns, row.charts.size());
    width_ = static_cast<double>(columns) * (sheet_.chart_width + kColumnGap) - kColumnGap;
    if (!sheet_.rows.empty()) legend_ = legend_of(sheet_, width_);
  }

  bool empty() const { return sheet_.rows.empty(); }
  double width() const { return width_ + 2 * kMargin; }

  double height() const {
    double height = 2 * kMargin + titles_height();
    for (const ChartRow& row : sheet_.rows) height += row_height(row) + kRowGap;
    return height + static_cast<double>(legend_.lines) * legend_.height;
  }

  void draw(Canvas& canvas) const {
    for (std::size_t i = 0; i < sheet_.titles.size(); ++i)
      canvas.text(sheet_.titles[i], {left_of(i) + sheet_.chart_width / 2, kMargin}, kTitle);
    double top = kMargin + titles_height();
    for (const ChartRow& row : sheet_.rows) {
      draw_row(canvas, row, top);
      top += row_height(row) + kRowGap;
    }
    draw_legend(canvas, top);
  }

 private:
  static double line_height() { return measure_text("0", kTitle).height; }
  double titles_height() const { return sheet_.titles.empty() ? 0 : line_height(); }
  double chart_height() const { return kHeightOfWidth * sheet_.chart_width; }
  double row_height(const ChartRow& row) const {
    return chart_height() + (row.title.empty() ? 0 : line_height());
  }
  double left_of(std::size_t column) const {
    return kMargin + static_cast<double>(column) * (sheet_.chart_width + kColumnGap);
  }

  void draw_row(Canvas& canvas, const ChartRow& row, double top) const {
    canvas.text(row.title, {kMargin, top}, kRowTitle);
    const double chart_top = top + row_height(row) - chart_height();
    for (std::size_t i = 0; i < row.charts.size(); ++i)
      if (has_points(row.charts[i]))
        draw_chart(
            canvas, {left_of(i), chart_top, sheet_.chart_width, chart_height()}, row.charts[i]
        );
  }

  void draw_legend(Canvas& canvas, double top) const {
    const double used = static_cast<double>(legend_.columns) * legend_.width - kEntryGap;
    const double left = kMargin + std::max(0.0, (width_ - used) / 2);
    std::size_t i = 0;
    for (const auto& [index, entry] : legend_.entries) {
      const double x = left + static_cast<double>(i / legend_.lines) * legend_.width;
      const double y = top + static_cast<double>(i % legend_.lines) * legend_.height;
      draw_entry(canvas, index, entry, {x, y});
      ++i;
    }
  }

  void draw_entry(Canvas& canvas, std::size_t index, Entry entry, Point at) const {
    const double middle = at.y + measure_text("0", kName).height / 2;
    const Point sample[] = {{at.x, middle}, {at.x + kSample, middle}};
    const SeriesStyle style = series_style(index);
    if (entry.line) draw_series_line(canvas, sample, style);
    if (entry.dots) draw_series_dot(canvas, {at.x + kSample / 2, middle}, style);
    canvas.text(sheet_.names[index], {at.x + kSample + kSampleGap, at.y}, kName);
  }

  ChartSheet sheet_;
  Legend legend_;
  double width_ = 0;  // of the charts, points
};

}  // namespace

Drawing draw_charts(const ChartSheet& sheet) {
  const auto drawing = std::make_shared<const SheetDrawing>(sheet);
  if (drawing->empty()) return {};
  return {
      drawing->width(), drawing->height(), 4, [drawing](Canvas& canvas) { drawing->draw(canvas); }};
}

}  // namespace glint
