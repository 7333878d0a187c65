// SPDX-License-Identifier: MIT
#include "glint/drawing/canvas.h"

#include <cairo-pdf.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "glint/core/error.h"
#include "glint/scene/image_files.h"

namespace glint {

namespace {

constexpr double kDotBorder = 0.4;  // points

struct SurfaceDeleter {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
struct CairoDeleter {
  void operator()(cairo_t* cairo) const { cairo_destroy(cairo); }
};
using Surface = std::unique_ptr<cairo_surface_t, SurfaceDeleter>;

void set_color(cairo_t* cairo, Color color) {
  cairo_set_source_rgb(cairo, color.red, color.green, color.blue);
}

void set_path(cairo_t* cairo, std::span<const Point> points) {
  cairo_new_path(cairo);  // a text leaves a point behind
  for (const Point& point : points) cairo_line_to(cairo, point.x, point.y);
}

void apply(cairo_t* cairo, const Stroke& stroke) {
  set_color(cairo, stroke.color);
  cairo_set_line_width(cairo, stroke.width);
  cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
  cairo_set_dash(cairo, stroke.dashes.data(), static_cast<int>(stroke.dashes.size()), 0);
  cairo_stroke(cairo);
}

std::uint32_t packed_pixel(const unsigned char* pixel, int channels) {
  std::uint32_t packed = 0;
  for (int c = 0; c < 3; ++c) packed = packed << 8 | pixel[channels == 1 ? 0 : c];
  return packed;
}

// cairo's pixels are rows of 32-bit numbers 0x00rrggbb.
std::uint32_t* row_of(cairo_surface_t* surface, int y) {
  return reinterpret_cast<std::uint32_t*>(
      cairo_image_surface_get_data(surface) + y * cairo_image_surface_get_stride(surface)
  );
}

Surface surface_of(ByteView image) {
  Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, image.width, image.height));
  cairo_surface_flush(surface.get());
  const unsigned char* pixel = image.data;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x, pixel += image.channels)
      row_of(surface.get(), y)[x] = packed_pixel(pixel, image.channels);
  cairo_surface_mark_dirty(surface.get());
  return surface;
}

// The box whose corners lie on whole pixels, at least one pixel large.
Box on_whole_pixels(cairo_t* cairo, const Box& box) {
  double left = box.left, top = box.top, width = box.width, height = box.height;
  cairo_user_to_device(cairo, &left, &top);
  cairo_user_to_device_distance(cairo, &width, &height);
  left = std::round(left), top = std::round(top);
  width = std::max(1.0, std::round(width)), height = std::max(1.0, std::round(height));
  cairo_device_to_user(cairo, &left, &top);
  cairo_device_to_user_distance(cairo, &width, &height);
  return {left, top, width, height};
}

void check(cairo_status_t status, const char* what) {
  GLINT_CHECK(
      status == CAIRO_STATUS_SUCCESS,
      kEnvironment,
      "{} could not be drawn: {}",
      what,
      cairo_status_to_string(status)
  );
}

// Errors (kEnvironment): no memory.
void paint(const Drawing& drawing, cairo_surface_t* surface, bool pixels) {
  const std::unique_ptr<cairo_t, CairoDeleter> cairo(cairo_create(surface));
  if (pixels) {
    set_color(cairo.get(), kPaper);
    cairo_paint(cairo.get());
    cairo_scale(cairo.get(), drawing.pixels_per_point, drawing.pixels_per_point);
  }
  Canvas canvas(cairo.get(), pixels);
  drawing.paint(canvas);
  check(cairo_status(cairo.get()), pixels ? "a picture" : "a PDF");
}

cairo_status_t append(void* to, const unsigned char* data, unsigned int size) {
  static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), size);
  return CAIRO_STATUS_SUCCESS;
}

ByteImage bytes_of(cairo_surface_t* surface) {
  cairo_surface_flush(surface);
  const int width = cairo_image_surface_get_width(surface);
  ByteImage image(width, cairo_image_surface_get_height(surface), 3);
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = static_cast<unsigned char>(row_of(surface, y)[x] >> (16 - 8 * c) & 255);
  return image;
}

}  // namespace

void Canvas::line(std::span<const Point> points, const Stroke& stroke) {
  set_path(cairo_, points);
  apply(cairo_, stroke);
}

void Canvas::rectangle(const Box& box, const Stroke& stroke) {
  cairo_rectangle(cairo_, box.left, box.top, box.width, box.height);
  apply(cairo_, stroke);
}

void Canvas::fill(const Box& box, Color color) {
  set_color(cairo_, color);
  cairo_rectangle(cairo_, box.left, box.top, box.width, box.height);
  cairo_fill(cairo_);
}

void Canvas::fill_dot(std::span<const Point> corners, Color color) {
  set_path(cairo_, corners);
  cairo_close_path(cairo_);
  fill_dot_path(color);
}

void Canvas::fill_dot(Point center, double radius, Color color) {
  cairo_new_path(cairo_);
  cairo_arc(cairo_, center.x, center.y, radius, 0, 2 * std::numbers::pi);
  cairo_close_path(cairo_);
  fill_dot_path(color);
}

void Canvas::fill_dot_path(Color color) {
  set_color(cairo_, color);
  cairo_fill_preserve(cairo_);
  apply(cairo_, {kPaper, kDotBorder, {}});
}

void Canvas::picture(ImageView image, const Box& box) { picture(to_bytes(image), box); }

void Canvas::picture(ByteView image, const Box& box) {
  const Surface surface = surface_of(image);
  const Box place = pixels_ ? on_whole_pixels(cairo_, box) : box;
  cairo_save(cairo_);
  cairo_translate(cairo_, place.left, place.top);
  cairo_scale(cairo_, place.width / image.width, place.height / image.height);
  cairo_set_source_surface(cairo_, surface.get(), 0, 0);
  cairo_pattern_set_filter(cairo_get_source(cairo_), CAIRO_FILTER_NEAREST);
  cairo_rectangle(cairo_, 0, 0, image.width, image.height);
  cairo_fill(cairo_);
  cairo_restore(cairo_);
}

ByteImage draw_bytes(const Drawing& drawing) {
  const auto pixels = [&](double points) {
    return std::max(1, static_cast<int>(std::ceil(points * drawing.pixels_per_point - 1e-6)));
  };
  const Surface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, pixels(drawing.width), pixels(drawing.height))
  );
  check(cairo_surface_status(surface.get()), "a picture");
  paint(drawing, surface.get(), true);
  return bytes_of(surface.get());
}

Image draw_image(const Drawing& drawing) {
  const ByteImage bytes = draw_bytes(drawing);
  Image image(bytes.width(), bytes.height(), bytes.channels());
  for (std::size_t i = 0; i < bytes.values().size(); ++i)
    image.values()[i] = static_cast<float>(bytes.values()[i]) / 255;
  return image;
}

std::string draw_pdf(const Drawing& drawing) {
  std::string pdf;
  const Surface surface(
      cairo_pdf_surface_create_for_stream(append, &pdf, drawing.width, drawing.height)
  );
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
  paint(drawing, surface.get(), false);
  cairo_surface_finish(surface.get());
  check(cairo_surface_status(surface.get()), "a PDF");
  return pdf;
}

void write_drawing(const fs::path& png, const Drawing& drawing) {
  write_png(png, draw_bytes(drawing));
  write_file(fs::path(png).replace_extension(".pdf"), draw_pdf(drawing));
}

}  // namespace glint
