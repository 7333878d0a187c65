// SPDX-License-Identifier: MIT
// Charts with lines or points, drawn as pictures.
#pragma once

#include <string>
#include <vector>

#include "glint/core/image.h"

namespace glint {

inline constexpr int kChartWidth = 420, kChartHeight = 300;  // pixels

// How one of many series is told from the others: eight colours (Okabe and Ito, safe for
// colour-blind readers) times four patterns of a line or shapes of a dot. From `index` 32 on they
// repeat.
struct SeriesStyle {
  int color = 0, pattern = 0;
};
SeriesStyle series_style(std::size_t index);

struct ChartSeries {
  std::size_t index = 0;     // of series_style()
  std::vector<double> x, y;  // values that are not finite are left out
  bool points = false;       // a dot each; else joined by lines
};

struct Chart {
  std::string x_label, y_label;
  std::vector<ChartSeries> series;
};

// [kChartHeight][kChartWidth][3]. Empty: no series has a point.
Image draw_chart(const Chart& chart);

// The names with the line and the dot of each, `names[i]` of index i, dealt to `num_panels` panels
// as wide as a chart, in the order of reading down; panels that would have no name are left out.
std::vector<Image> draw_chart_legend(const std::vector<std::string>& names, std::size_t num_panels);

// About five round numbers (1, 2 or 5 times a power of ten) within [low, high].
std::vector<double> round_ticks(double low, double high);

}  // namespace glint
