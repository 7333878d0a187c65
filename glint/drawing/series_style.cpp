// SPDX-License-Identifier: MIT
#include "glint/drawing/series_style.h"

#include <array>

namespace glint {

namespace {

// Points: width of a line and of a bar, radius of a dot.
constexpr double kLine = 1.1, kDot = 2.2;
constexpr std::size_t kPatterns = 4;

constexpr Color of_bytes(int red, int green, int blue) {
  return {red / 255.0, green / 255.0, blue / 255.0};
}
// Okabe and Ito's, but for their yellow: brown is seen on white.
constexpr std::array<Color, 8> kColors{
    of_bytes(0, 114, 178),
    of_bytes(213, 94, 0),
    of_bytes(0, 158, 115),
    of_bytes(204, 121, 167),
    of_bytes(230, 159, 0),
    of_bytes(86, 180, 233),
    of_bytes(0, 0, 0),
    of_bytes(120, 90, 0)};

// Drawn and left out in turn, points; the first is one line without gaps.
const std::array<std::vector<double>, kPatterns> kDashes{
    {{}, {4.5, 2}, {1.3, 1.5}, {6, 1.7, 1.3, 1.7}}};

// Corners of the second to fourth shape, in radii of the first, a disk: square, triangle, diamond.
const std::array<std::vector<Point>, kPatterns - 1> kShapes{
    {{{-0.9, -0.9}, {0.9, -0.9}, {0.9, 0.9}, {-0.9, 0.9}},
     {{0, -1.2}, {1.15, 0.85}, {-1.15, 0.85}},
     {{0, -1.35}, {1.35, 0}, {0, 1.35}, {-1.35, 0}}}};

Color color_of(SeriesStyle style) { return kColors[static_cast<std::size_t>(style.color)]; }

}  // namespace

SeriesStyle series_style(std::size_t index) {
  const std::size_t color = index % kColors.size(), round = index / kColors.size();
  return {static_cast<int>(color), static_cast<int>((color + round) % kPatterns)};
}

void draw_series_line(Canvas& canvas, std::span<const Point> points, SeriesStyle style) {
  canvas.line(points, {color_of(style), kLine, kDashes[static_cast<std::size_t>(style.pattern)]});
}

void draw_series_dot(Canvas& canvas, Point center, SeriesStyle style) {
  if (style.pattern == 0) return canvas.fill_dot(center, kDot, color_of(style));
  std::vector<Point> corners;
  for (const Point& corner : kShapes[static_cast<std::size_t>(style.pattern) - 1])
    corners.push_back({center.x + kDot * corner.x, center.y + kDot * corner.y});
  canvas.fill_dot(corners, color_of(style));
}

}  // namespace glint
