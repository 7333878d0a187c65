// SPDX-License-Identifier: MIT
// How one of many series of a chart is told from the others.
#pragma once

#include <vector>

#include "glint/drawing/canvas.h"

namespace glint {

// Eight colours (Okabe and Ito, safe for colour-blind readers) times four patterns of a line, each
// with a shape of its dots. Neighbours differ in both, so that grey print tells them apart. From
// `index` 32 on they repeat.
struct SeriesStyle {
  int color = 0, pattern = 0;
};
SeriesStyle series_style(std::size_t index);

// A line in the style; it may have corners.
void draw_series_line(Canvas& canvas, std::span<const Point> points, SeriesStyle style);
void draw_series_dot(Canvas& canvas, Point center, SeriesStyle style);

}  // namespace glint
