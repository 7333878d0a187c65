// SPDX-License-Identifier: MIT
#include "glint/drawing/canvas.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include "glint/scene/image_files.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

constexpr double kPixels = 8;  // per point

Drawing page(double width, double height, std::function<void(Canvas&)> paint) {
  return {width, height, kPixels, std::move(paint)};
}

// The smallest box of pixels that holds all ink, in points.
Box ink_box(const Image& picture) {
  int left = picture.width(), right = -1, top = picture.height(), bottom = -1;
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x)
      if (picture.at(x, y, 1) < 0.5f) {
        left = std::min(left, x), right = std::max(right, x);
        top = std::min(top, y), bottom = std::max(bottom, y);
      }
  return {
      left / kPixels, top / kPixels, (right + 1 - left) / kPixels, (bottom + 1 - top) / kPixels};
}

Image text_image(const std::string& text, Point at, const TextStyle& style = {10}) {
  return draw_image(page(100, 60, [&](Canvas& canvas) { canvas.text(text, at, style); }));
}

bool same(const Image& a, const Image& b) {
  return a.size() == b.size() && std::equal(a.values().begin(), a.values().end(), b.data());
}

}  // namespace

TEST_CASE("the font is installed") { CHECK(found_font_family() == kFontFamily); }

TEST_CASE("letters lie where their measure says") {
  const TextSize size = measure_text("HI", {10});
  CHECK(size.height > 10);
  CHECK(size.width > 5);
  CHECK(size.width < 20);
  const Box ink = ink_box(text_image("HI", {20, 30}));
  CHECK(ink.left > 20);
  CHECK(ink.right() < 20 + size.width);
  CHECK(ink.bottom() == Approx(30 + size.baseline).margin(1 / kPixels));
  CHECK(ink.height == Approx(0.727 * 10).margin(1.5 / kPixels));  // Inter's capitals
  CHECK(measure_text("HIHI", {10}).width == Approx(2 * size.width).epsilon(0.05));
  CHECK(measure_text("HI", {20}).width == Approx(2 * size.width).epsilon(1e-3));
}

TEST_CASE("a text stands left of, around or right of its point") {
  const double width = measure_text("HHHH", {10}).width;
  for (const auto& [align, left] :
       {std::pair(Align::kLeft, 50.0),
        std::pair(Align::kCenter, 50 - width / 2),
        std::pair(Align::kRight, 50 - width)}) {
    const TextStyle style{10, false, align};
    CHECK(ink_box(text_image("HHHH", {50, 10}, style)).left == Approx(left).margin(1));
    TextStyle wide = style;
    wide.wrap = 45;  // changes nothing but where a line ends
    CHECK(same(text_image("HHHH", {50, 10}, wide), text_image("HHHH", {50, 10}, style)));
  }
}

TEST_CASE("long lines are broken, bold letters have more ink") {
  const double line = measure_text("two words", {10}).height;
  TextStyle narrow{10};
  narrow.wrap = 30;
  CHECK(measure_text("two words", narrow).height == Approx(2 * line));
  CHECK(measure_text("two words", narrow).width <= 30);
  CHECK(measure_text("two\nwords", {10}).height == Approx(2 * line));
  const auto ink = [](const Image& picture) {
    double sum = 0;
    for (const float value : picture.values()) sum += static_cast<double>(1 - value);
    return sum;
  };
  CHECK(ink(text_image("HI", {20, 30}, {10, true})) > 1.2 * ink(text_image("HI", {20, 30})));
}

TEST_CASE("a word behind a letter and '_' is lowered, names with '_' stay") {
  const Box plain = ink_box(text_image("L", {10, 10})),
            lowered = ink_box(text_image("L_H", {10, 10}));
  CHECK(lowered.bottom() > plain.bottom() + 0.5);
  CHECK(lowered.bottom() < plain.bottom() + 3);
  CHECK(measure_text("k_s", {10}).width < measure_text("ks", {10}).width);
  CHECK(measure_text("room_b", {10}).width > measure_text("roomb", {10}).width + 2);
}

TEST_CASE("turned text is read from below") {
  const Image picture = draw_image(page(40, 100, [](Canvas& canvas) {
    canvas.text_upwards("HHHH", {10, 90}, {10});
  }));
  const Box ink = ink_box(picture);
  CHECK(ink.height > 2 * ink.width);
  CHECK(ink.bottom() == Approx(90).margin(1.5));
  CHECK(ink.left > 10);
}

TEST_CASE("lines and dots start anew, wherever a text ended") {
  const auto corner = [](const std::function<void(Canvas&)>& mark) {
    const Image picture = draw_image(page(100, 60, [&](Canvas& canvas) {
      canvas.text("HI", {80, 40}, {10});
      mark(canvas);
    }));
    int ink = 0;  // between the text and the upper left corner
    for (int y = 0; y < 39 * kPixels; ++y)
      for (int x = 0; x < 79 * kPixels; ++x) ink += picture.at(x, y, 1) < 0.5f;
    return ink;
  };
  CHECK(corner([](Canvas&) {}) == 0);
  const Point outside[] = {{90, 55}, {95, 55}, {95, 58}};
  CHECK(corner([&](Canvas& canvas) { canvas.line(outside, {}); }) == 0);
  CHECK(corner([&](Canvas& canvas) { canvas.fill_dot(outside, kInk); }) == 0);
  CHECK(corner([&](Canvas& canvas) { canvas.fill_dot({90, 55}, 2, kInk); }) == 0);
}

TEST_CASE("a picture keeps its pixels where the page shows each as one or more") {
  Image picture(4, 2, 3);
  for (std::size_t i = 0; i < picture.values().size(); ++i)
    picture.values()[i] = static_cast<float>(10 * i) / 255;
  const Drawing exact{4.2, 3.1, 1, [&](Canvas& canvas) {
                        canvas.picture(picture, {0.3, 1.2, 4, 2});
                      }};
  const Image drawn = draw_image(exact);
  REQUIRE(drawn.size() == ImageSize{5, 4});
  const Drawing larger{4, 2, 3, [&](Canvas& canvas) { canvas.picture(picture, {0, 0, 4, 2}); }};
  const Image large = draw_image(larger);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x)
      for (int c = 0; c < 3; ++c) {
        CHECK(drawn.at(x, y + 1, c) == picture.at(x, y, c));
        CHECK(large.at(3 * x, 3 * y + 2, c) == picture.at(x, y, c));
        CHECK(large.at(3 * x + 2, 3 * y, c) == picture.at(x, y, c));
      }
  CHECK(drawn.at(4, 0, 0) == 1);
}

TEST_CASE("bytes round half to even as in PNG files, values out of range are clamped") {
  const auto shown = [](float value) {
    const Image one(1, 1, 1, value);
    const Drawing drawing{1, 1, 1, [&](Canvas& canvas) { canvas.picture(one, {0, 0, 1, 1}); }};
    return draw_image(drawing).at(0, 0, 2) * 255;
  };
  CHECK(shown(0.5f) == 128);  // 127.5
  CHECK(shown(-3) == 0);
  CHECK(shown(7) == 255);
}

TEST_CASE("a drawing is a PNG and a PDF with the same words, and the same bytes each time") {
  const test::TempFolder folder;
  const Drawing drawing = page(100, 50, [](Canvas& canvas) {
    const Point points[] = {{5, 5}, {95, 45}};
    canvas.line(points, {});
    canvas.picture(Image(3, 2, 3, 0.5f), {5, 20, 30, 20});
    canvas.text("Words of a figure", {10, 10}, {10});
  });
  write_drawing(folder / "a.png", drawing);
  CHECK(read_image(folder / "a.png", 3).size() == ImageSize{800, 400});
  const std::string pdf = read_file(folder / "a.pdf");
  CHECK(pdf.starts_with("%PDF-1."));
  CHECK(pdf.find("%%EOF") != std::string::npos);
  CHECK(pdf.find("/MediaBox [ 0 0 100 50 ]") != std::string::npos);
  CHECK(pdf.find("Inter") != std::string::npos);            // the font is embedded
  CHECK(pdf.find("/Subtype /Image") != std::string::npos);  // the picture as pixels
  CHECK(pdf.find("/CreationDate") == std::string::npos);
  write_drawing(folder / "b.png", drawing);
  CHECK(read_file(folder / "b.pdf") == pdf);
  CHECK(read_file(folder / "b.png") == read_file(folder / "a.png"));
}
