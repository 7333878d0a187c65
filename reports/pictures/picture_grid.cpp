// SPDX-License-Identifier: MIT
#include "reports/pictures/picture_grid.h"

#include <algorithm>
#include <sstream>

#include "glint/scene/image_files.h"

namespace glint {

namespace {

constexpr int kGap = 4;         // pixels between panels
constexpr int kMaxLetter = 16;  // pixels
constexpr int kStripes = 8;     // pixels from one to the next

// Sizes of a grid in pixels.
struct Layout {
  int margin = 0;         // width of the rows' titles
  int column = 0;         // width of a panel
  int letter = 0;         // height of capitals
  int line = 0;           // height of a line of text
  int baseline = 0;       // of a line, from its top
  int bar = 0;            // width of the colour bar
  std::vector<int> rows;  // heights
};

int height_of(const std::vector<Image>& row) {
  int height = 0;
  for (const Image& panel : row) height = std::max(height, panel.height());
  return height;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

Layout layout_of(const PictureGrid& grid) {
  Layout layout;
  layout.column = kMinPanelWidth;
  for (const auto& row : grid.rows) {
    layout.rows.push_back(height_of(row));
    for (const Image& panel : row) layout.column = std::max(layout.column, panel.width());
  }
  layout.letter = std::min(layout.column / 20, kMaxLetter);
  layout.line = 2 * layout.letter;
  layout.baseline = layout.line - layout.letter / 2;
  layout.bar = layout.column / 2;
  for (const std::string& title : grid.row_titles)
    for (const std::string& line : lines_of(title))
      layout.margin = std::max(layout.margin, text_width(line, layout.letter) + 3 * kGap);
  return layout;
}

int left_of(std::size_t column, const Layout& layout) {
  return layout.margin + static_cast<int>(column) * (layout.column + kGap);
}

int width_of(const LegendLine& line, const Layout& layout) {
  int width = kGap + text_width(line.text, layout.letter) + layout.letter;
  if (line.bar != LegendBar::kNone)
    width += layout.bar + layout.letter + text_width(line.rest, layout.letter) + layout.letter;
  return width;
}

void paste(const Image& panel, int left, int top, Image& picture) {
  for (int y = 0; y < panel.height(); ++y)
    std::copy_n(panel.pixel(0, y), panel.width() * panel.channels(), picture.pixel(left, top + y));
}

Image plain_bar(LegendBar bar, int width, int height) {
  Image picture(width, height, 3, kNothingGrey);
  if (bar == LegendBar::kHatch)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) std::copy_n(hatch_color(x, y).data(), 3, picture.pixel(x, y));
  return picture;
}

Image color_bar(LegendBar bar, int width, int height) {
  if (bar == LegendBar::kHatch || bar == LegendBar::kGrey) return plain_bar(bar, width, height);
  Image ramp(width, height, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) ramp.at(x, y) = static_cast<float>(x + 1);
  const float high = static_cast<float>(width);
  if (bar == LegendBar::kDepth) return colorize_depth(ramp, 1, high);
  const bool share = bar == LegendBar::kShare;
  return colorize_scalar(ramp, 1, high, share ? ScalarColors::kViridis : ScalarColors::kMagma);
}

void draw_legend_line(const LegendLine& line, int top, const Layout& layout, Image& picture) {
  const int baseline = top + layout.baseline;
  int left = kGap;
  draw_text(picture, line.text, left, baseline, layout.letter);
  if (line.bar == LegendBar::kNone) return;
  left += text_width(line.text, layout.letter) + layout.letter;
  paste(color_bar(line.bar, layout.bar, layout.letter), left, baseline - layout.letter, picture);
  left += layout.bar + layout.letter;
  draw_text(picture, line.rest, left, baseline, layout.letter);
}

Image white_picture(const PictureGrid& grid, const Layout& layout) {
  int width = left_of(grid.titles.size(), layout) - kGap;
  for (const LegendLine& line : grid.legend) width = std::max(width, width_of(line, layout));
  int height = layout.line * static_cast<int>(1 + grid.legend.size());
  for (const int row : layout.rows) height += row + kGap;
  return Image(width, height, 3, 1.0f);
}

void draw_row(
    const std::vector<Image>& row, int top, int height, const Layout& layout, Image& picture
) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    const int left = left_of(i, layout);
    paste(
        row[i].empty() ? Image(layout.column, height, 3, kNothingGrey) : row[i], left, top, picture
    );
    if (row[i].empty())
      draw_text(picture, "missing", left + 2 * kGap, top + layout.line, layout.letter);
  }
}

void draw_row_title(const std::string& title, int top, const Layout& layout, Image& picture) {
  for (const std::string& line : lines_of(title)) {
    draw_text(picture, line, kGap, top + layout.baseline, layout.letter);
    top += layout.line;
  }
}

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

Image draw_grid(const PictureGrid& grid) {
  const Layout layout = layout_of(grid);
  Image picture = white_picture(grid, layout);
  for (std::size_t i = 0; i < grid.titles.size(); ++i) {
    const int left = left_of(i, layout) + kGap;
    draw_text(picture, grid.titles[i], left, layout.baseline, layout.letter);
  }
  int top = layout.line;
  for (std::size_t i = 0; i < grid.rows.size(); ++i) {
    draw_row(grid.rows[i], top, layout.rows[i], layout, picture);
    if (i < grid.row_titles.size()) draw_row_title(grid.row_titles[i], top, layout, picture);
    top += layout.rows[i] + kGap;
  }
  for (const LegendLine& line : grid.legend) {
    draw_legend_line(line, top, layout, picture);
    top += layout.line;
  }
  return picture;
}

}  // namespace glint
