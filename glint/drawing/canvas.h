// SPDX-License-Identifier: MIT
// What is drawn for people to look at: lines, letters and pictures on a white page that is measured
// in points (1/72 inch), as pixels or as a PDF whose letters and lines are vectors. By cairo and
// pango; letters are placed without hinting, so that both have the same layout.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "glint/core/files.h"
#include "glint/core/image.h"

typedef struct _cairo cairo_t;

namespace glint {

// From the page's top left corner, y downwards, points.
struct Point {
  double x = 0, y = 0;
};
struct Box {
  double left = 0, top = 0, width = 0, height = 0;
  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

struct Color {
  double red = 0, green = 0, blue = 0;  // as displayed, [0, 1]
};
inline constexpr Color kInk{0.1, 0.1, 0.1}, kPaper{1, 1, 1};

struct Stroke {
  Color color = kInk;
  double width = 0.5;              // points
  std::span<const double> dashes;  // drawn and left out in turn, points; empty: without gaps
};

// Where a text stands to the point that it is drawn at; the point's y is the top of the first line.
enum class Align { kLeft, kCenter, kRight };

struct TextStyle {
  double size = 7;  // points
  bool bold = false;
  Align align = Align::kLeft;
  double wrap = 0;  // lines end before this width, points; 0: only at '\n'
  Color color = kInk;
};

struct TextSize {
  double width = 0, height = 0;            // points, all lines
  double baseline = 0, last_baseline = 0;  // of the first and the last line, from the top
};

// UTF-8, of which '_' behind a single letter lowers the word that follows: k_s, G_trans.
TextSize measure_text(const std::string& text, const TextStyle& style = {});

// The family of all letters, and what stands in where that is not installed.
inline constexpr const char* kFontFamily = "Inter";  // Debian: fonts-inter
std::string found_font_family();

class Canvas {
 public:
  // `pixels`: pictures end at whole ones.
  Canvas(cairo_t* cairo, bool pixels) : cairo_(cairo), pixels_(pixels) {}

  void line(std::span<const Point> points, const Stroke& stroke);
  void rectangle(const Box& box, const Stroke& stroke);
  void fill(const Box& box, Color color);
  // With a thin border of paper, which separates it from what it covers.
  void fill_dot(std::span<const Point> corners, Color color);
  void fill_dot(Point center, double radius, Color color);
  void text(const std::string& text, Point at, const TextStyle& style = {});
  // Read from below: turned about `at` by a quarter.
  void text_upwards(const std::string& text, Point at, const TextStyle& style = {});
  // 1 or 3 channels; pixels stay squares. Floats by to_bytes() (glint/scene/image_files.h).
  void picture(ByteView image, const Box& box);
  void picture(ImageView image, const Box& box);

 private:
  void fill_dot_path(Color color);

  cairo_t* cairo_;
  bool pixels_;
};

struct Drawing {
  double width = 0, height = 0;  // points
  double pixels_per_point = 4;   // of the picture
  std::function<void(Canvas&)> paint;
  bool empty() const { return !paint; }
};

// [H][W][3] on white.
ByteImage draw_bytes(const Drawing& drawing);
Image draw_image(const Drawing& drawing);
// The same bytes for the same drawing: without a date.
std::string draw_pdf(const Drawing& drawing);
// PATH.png, and the same as PATH.pdf beside it. Errors (kEnvironment): cannot be written.
void write_drawing(const fs::path& png, const Drawing& drawing);

}  // namespace glint
