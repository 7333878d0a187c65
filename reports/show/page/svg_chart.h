// SPDX-License-Identifier: MIT
// A small chart as SVG text: the same values give the same bytes on every machine, so that it can
// be committed, and pages hold it without a program.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reports/show/tables/statistics.h"

namespace glint {

struct SvgSeries {
  std::string name;
  std::vector<double> x, y;                        // joined by a line, with a dot each
  std::vector<std::optional<Interval>> intervals;  // of each point, as a bar; may be empty
};

struct SvgTick {
  double at = 0;
  std::string text;
};

struct SvgChart {
  std::string title, x_label, y_label;  // title: for readers of screens
  std::vector<SvgTick> x_ticks;         // in order; the first and the last are the ends
  Interval y{0, 1};                     // from bottom to top
  int decimals = 1;                     // of the ticks at its side
  std::optional<Interval> band;         // shaded, across
  std::string band_name;
  std::vector<SvgSeries> series;
};

// Names and labels may hold anything. Values that are not finite are left out.
std::string svg_chart(const SvgChart& chart);

// The least range with room around the values; 0 to 1 where there is none.
Interval range_around(const std::vector<SvgSeries>& series);

}  // namespace glint
