// SPDX-License-Identifier: MIT
#include "glint/drawing/picture_grid.h"

#include <algorithm>
#include <memory>

#include "glint/drawing/color_maps.h"

namespace glint {

namespace {

// All in points.
constexpr double kPageWidth = 504;  // 7 inches, the width of a paper's text
constexpr double kMargin = 2, kGap = 2.5, kTextGap = 4;
constexpr double kMinColumn = 56;    // "transmission" fits
constexpr double kMaxRowTitle = 90;  // longer ones are broken
constexpr double kBarWidth = 90, kSwatchWidth = 18, kBarHeight = 6;
constexpr double kPixelsPerPoint = 2.5;  // at least: letters stay sharp
constexpr int kStripes = 8;              // pixels from one to the next
const TextStyle kTitle{7, true, Align::kCenter}, kRowTitle{7}, kLegend{6.5};

bool is_swatch(LegendBar bar) { return bar == LegendBar::kHatch || bar == LegendBar::kGrey; }

Image plain_bar(LegendBar bar, int width, int height) {
  Image picture(width, height, 3, kNothingGrey);
  if (bar == LegendBar::kHatch)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) std::copy_n(hatch_color(x, y).data(), 3, picture.pixel(x, y));
  return picture;
}

Image color_bar(LegendBar bar) {
  constexpr int kSteps = 256;
  if (is_swatch(bar)) return plain_bar(bar, 6 * kStripes, 2 * kStripes);
  Image ramp(kSteps, 1, 1);
  for (int x = 0; x < kSteps; ++x) ramp.at(x, 0) = static_cast<float>(x + 1);
  if (bar == LegendBar::kDepth) return colorize_depth(ramp, 1, kSteps);
  const bool share = bar == LegendBar::kShare;
  return colorize_scalar(ramp, 1, kSteps, share ? ScalarColors::kViridis : ScalarColors::kMagma);
}

TextStyle wrapped(TextStyle style, double width) {
  style.wrap = width;
  return style;
}

double width_of(LegendBar bar) { return is_swatch(bar) ? kSwatchWidth : kBarWidth; }

bool has_bar(const LegendLine& line) { return line.bar != LegendBar::kNone; }

double text_width(const std::string& text) { return measure_text(text, kLegend).width; }

// From the page's margin: the bars of all lines stand below each other.
double bar_left(const std::vector<LegendLine>& legend) {
  double left = 0;
  for (const LegendLine& line : legend)
    if (has_bar(line)) left = std::max(left, text_width(line.text) + kTextGap);
  return left;
}

class GridDrawing {
 public:
  explicit GridDrawing(PictureGrid grid) : grid_(std::move(grid)) {
    measure_columns();
    measure_rows();
    bar_left_ = bar_left(grid_.legend);
    width_ = columns_width();
    for (const LegendLine& line : grid_.legend) width_ = std::max(width_, wanted_width(line));
    for (const std::string& title : grid_.titles) {
      const TextSize size = measure_text(title, wrapped(kTitle, column_));
      titles_baseline_ = std::max(titles_baseline_, size.last_baseline);
      below_ = std::max(below_, size.height - size.last_baseline);
    }
  }

  double width() const { return width_ + 2 * kMargin; }
  double pixels_per_point() const { return pixels_ / column_; }

  double height() const {
    double height = 2 * kMargin + static_cast<double>(starts_.size()) * band_height();
    for (const LegendLine& line : grid_.legend) height += height_of(line);
    return height;
  }

  void draw(Canvas& canvas) const {
    double top = kMargin;
    for (std::size_t band = 0; band < starts_.size(); ++band) {
      draw_titles(canvas, band, top);
      double row_top = top + titles_height();
      for (std::size_t i = 0; i < rows_.size(); ++i) {
        draw_row(canvas, band, i, row_top);
        row_top += rows_[i] + kGap;
      }
      top += band_height();
    }
    for (const LegendLine& line : grid_.legend) {
      draw_legend(canvas, line, top);
      top += height_of(line);
    }
  }

 private:
  // A line with a bar is never broken.
  double wanted_width(const LegendLine& line) const {
    if (!has_bar(line)) return std::min(text_width(line.text), kPageWidth - 2 * kMargin);
    const double rest = line.rest.empty() ? 0 : kTextGap + text_width(line.rest);
    return bar_left_ + width_of(line.bar) + rest;
  }

  double titles_height() const { return titles_baseline_ + below_ + kGap; }
  double band_height() const {
    double height = titles_height();
    for (const double row : rows_) height += row + kGap;
    return height;
  }

  double columns_width() const {
    return row_titles_ + static_cast<double>(num_columns_) * (column_ + kGap) - kGap;
  }
  std::size_t end_of(std::size_t band, std::size_t count) const {
    return band + 1 < starts_.size() ? std::min(starts_[band + 1], count) : count;
  }
  // Calls f(column, its left edge) for a band's columns among `count`.
  template <class F>
  void for_columns(std::size_t band, std::size_t count, F&& f) const {
    double left = kMargin + row_titles_;
    for (std::size_t i = starts_[band]; i < end_of(band, count); ++i, left += column_ + kGap)
      f(i, left);
  }

  // As wide as the page leaves room for, but not so wide that letters have few pixels.
  void measure_columns() {
    num_columns_ = std::max<std::size_t>(1, grid_.titles.size());
    for (const auto& row : grid_.rows) {
      num_columns_ = std::max(num_columns_, row.size());
      for (const Panel& panel : row) pixels_ = std::max(pixels_, panel.size().width);
    }
    if (pixels_ == 0) pixels_ = kMinPanelWidth;
    for (const std::string& title : grid_.row_titles)
      row_titles_ = std::max(row_titles_, measure_text(title, row_style()).width + kTextGap);
    if (grid_.bands) fold_columns();
    const auto count = static_cast<double>(num_columns_);
    const double fit = (kPageWidth - 2 * kMargin - row_titles_ - (count - 1) * kGap) / count;
    column_ = std::min(std::max(fit, kMinColumn), std::max(kMinColumn, pixels_ / kPixelsPerPoint));
  }

  // As few bands as the page's width allows, each with about as many columns.
  void fold_columns() {
    const double room = kPageWidth - 2 * kMargin - row_titles_ + kGap;
    const auto most = static_cast<std::size_t>(std::max(1.0, room / (kMinColumn + kGap)));
    const std::size_t count = num_columns_, bands = (count + most - 1) / most;
    const std::size_t even = (count + bands - 1) / bands;
    for (std::size_t next = even; next < count; next += even) {
      std::size_t start = next;
      while (grid_.joined.count(start) > 0 && start > starts_.back()) --start;
      if (start > starts_.back()) starts_.push_back(start);
    }
    num_columns_ = 0;
    for (std::size_t band = 0; band < starts_.size(); ++band)
      num_columns_ = std::max(num_columns_, end_of(band, count) - starts_[band]);
  }

  void measure_rows() {
    for (std::size_t i = 0; i < grid_.rows.size(); ++i) {
      double height = i < grid_.row_titles.size()
                          ? measure_text(grid_.row_titles[i], row_style()).height
                          : measure_text("missing", kRowTitle).height;
      for (const Panel& panel : grid_.rows[i])
        height = std::max(height, panel.size().height / pixels_per_point());
      rows_.push_back(height);
    }
  }

  static TextStyle row_style() { return wrapped(kRowTitle, kMaxRowTitle); }

  // The last lines of all titles stand side by side.
  void draw_titles(Canvas& canvas, std::size_t band, double top) const {
    const TextStyle style = wrapped(kTitle, column_);
    for_columns(band, grid_.titles.size(), [&](std::size_t i, double left) {
      const double last = measure_text(grid_.titles[i], style).last_baseline;
      canvas.text(grid_.titles[i], {left + column_ / 2, top + titles_baseline_ - last}, style);
    });
  }

  void draw_row(Canvas& canvas, std::size_t band, std::size_t row, double top) const {
    if (row < grid_.row_titles.size()) {
      const double height = measure_text(grid_.row_titles[row], row_style()).height;
      canvas.text(grid_.row_titles[row], {kMargin, top + (rows_[row] - height) / 2}, row_style());
    }
    for_columns(band, grid_.rows[row].size(), [&](std::size_t i, double left) {
      draw_panel(canvas, grid_.rows[row][i], {left, top, column_, rows_[row]});
    });
  }

  void draw_panel(Canvas& canvas, const Panel& panel, Box box) const {
    if (panel.empty()) {
      canvas.picture(Image(1, 1, 3, kNothingGrey), box);
      const double text = measure_text("missing", kRowTitle).height;
      TextStyle style = kRowTitle;
      style.align = Align::kCenter;
      style.color = kPaper;
      canvas.text("missing", {box.left + box.width / 2, box.top + (box.height - text) / 2}, style);
      return;
    }
    box.width = panel.size().width / pixels_per_point();
    box.height = panel.size().height / pixels_per_point();
    canvas.picture(panel.bytes(), box);
  }

  double height_of(const LegendLine& line) const {
    const TextStyle style = has_bar(line) ? kLegend : wrapped(kLegend, width_);
    return measure_text(line.text, style).height + kGap / 2;
  }

  void draw_legend(Canvas& canvas, const LegendLine& line, double top) const {
    if (!has_bar(line)) return canvas.text(line.text, {kMargin, top}, wrapped(kLegend, width_));
    canvas.text(line.text, {kMargin, top}, kLegend);
    const double left = kMargin + bar_left_, height = measure_text(line.text, kLegend).height;
    const double width = width_of(line.bar);
    canvas.picture(color_bar(line.bar), {left, top + (height - kBarHeight) / 2, width, kBarHeight});
    canvas.text(line.rest, {left + width + kTextGap, top}, kLegend);
  }

  PictureGrid grid_;
  std::size_t num_columns_ = 0;                     // of the widest band
  std::vector<std::size_t> starts_ = {0};           // first columns of the bands
  int pixels_ = 0;                                  // width of a panel
  double column_ = 0, row_titles_ = 0, width_ = 0;  // points
  double titles_baseline_ = 0, below_ = 0;          // of the titles: last baseline, from there on
  double bar_left_ = 0;
  std::vector<double> rows_;  // heights, points
};

}  // namespace

std::array<float, 3> hatch_color(int x, int y) {
  if ((x + y) % kStripes < 3) return {0.35f, 0.6f, 0.85f};
  return {0.75f, 0.88f, 0.97f};
}

Image fit_panel(const Image& panel) {
  if (panel.width() > kMaxPanelWidth) {
    const int height = std::max(1, panel.height() * kMaxPanelWidth / panel.width());
    return resize_image(panel, {kMaxPanelWidth, height});
  }
  const int factor = (kMinPanelWidth + panel.width() - 1) / panel.width();
  if (factor <= 1) return panel;
  Image large(panel.width() * factor, panel.height() * factor, panel.channels());
  for (int y = 0; y < large.height(); ++y)
    for (int x = 0; x < large.width(); ++x)
      std::copy_n(panel.pixel(x / factor, y / factor), panel.channels(), large.pixel(x, y));
  return large;
}

Drawing draw_grid(PictureGrid grid) {
  if (grid.rows.empty()) return {};
  const auto drawing = std::make_shared<const GridDrawing>(std::move(grid));
  return {
      drawing->width(), drawing->height(), drawing->pixels_per_point(), [drawing](Canvas& canvas) {
        drawing->draw(canvas);
      }};
}

}  // namespace glint
