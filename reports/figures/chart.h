// SPDX-License-Identifier: MIT
// Charts with lines or points, drawn as pictures.
#pragma once

#include <string>
#include <vector>

#include "glint/core/image.h"

namespace glint {

inline constexpr int kChartWidth = 420, kChartHeight = 300;  // pixels, without the legend

struct ChartSeries {
  std::string name;
  std::vector<double> x, y;  // values that are not finite are left out
  bool points = false;       // a dot each; else joined by lines
};

struct Chart {
  std::string x_label, y_label;
  std::vector<ChartSeries> series;
};

// [kChartHeight + a line per series][kChartWidth][3]: the legend is below. Colours go by the
// position of a series (Okabe and Ito, safe for colour-blind readers); from the ninth on they
// repeat with thinner lines and smaller dots. Empty: no series has a point.
Image draw_chart(const Chart& chart);

// About five round numbers (1, 2 or 5 times a power of ten) within [low, high].
std::vector<double> round_ticks(double low, double high);

}  // namespace glint
