// SPDX-License-Identifier: MIT
// Charts with lines or points, in rows that share a legend; sizes are those of a paper's page.
#pragma once

#include <string>
#include <vector>

#include "glint/drawing/canvas.h"
#include "glint/drawing/series_style.h"

namespace glint {

struct ChartSeries {
  std::size_t index = 0;     // of series_style() and of ChartSheet::names
  std::vector<double> x, y;  // values that are not finite are left out, and end a line
  bool points = false;       // a dot each; else joined by lines, of few points with dots
};

struct Chart {
  std::string x_label, y_label;
  std::vector<ChartSeries> series;
  bool logarithmic = false;    // both axes; values that are not above 0 are left out
  bool logarithmic_y = false;  // that axis, likewise
};

bool has_points(const Chart& chart);
bool has_dots(const ChartSeries& series);  // each point is drawn, too, or only

// Axes, marks and labels lie within the box. The chart has points.
void draw_chart(Canvas& canvas, const Box& box, const Chart& chart);

struct ChartRow {
  std::string title;          // empty: none
  std::vector<Chart> charts;  // one without points leaves its place empty
};

struct ChartSheet {
  std::vector<std::string> titles;  // one a column; may be none
  std::vector<ChartRow> rows;
  std::vector<std::string> names;  // of the series, by index; those without a point are left out
  double chart_width = 160;        // points; three of them fill a page that is 7 inches wide
};

// Empty: no chart has points.
Drawing draw_charts(const ChartSheet& sheet);

}  // namespace glint
