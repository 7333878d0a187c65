// SPDX-License-Identifier: MIT
#include "reports/pictures/frame_sheet.h"

#include <cmath>

#include "glint/drawing/picture_grid.h"

namespace glint {

namespace {

constexpr int kTitleHeight = 20, kGap = 6;  // pixels
constexpr double kTitleSize = 12;           // pixels
constexpr double kWantedAspect = 16.0 / 9;

struct SheetLayout {
  int columns = 1, rows = 1;
  ImageSize panel;
  int width() const { return even(columns * (panel.width + kGap) + kGap); }
  int height() const { return even(rows * (panel.height + kTitleHeight + kGap)); }

 private:
  static int even(int pixels) { return pixels + pixels % 2; }
};

SheetLayout best_layout(int count, ImageSize panel) {
  SheetLayout best;
  double least = INFINITY;
  for (int columns = 1; columns <= count; ++columns) {
    const SheetLayout layout{columns, (count + columns - 1) / columns, panel};
    const double off =
        std::abs(std::log(static_cast<double>(layout.width()) / layout.height() / kWantedAspect));
    if (off < least) least = off, best = layout;
  }
  return best;
}

Image draw_frame_sheet(const std::vector<TitledPicture>& pictures) {
  std::vector<Image> panels;
  for (const TitledPicture& picture : pictures) panels.push_back(fit_panel(picture.picture));
  const SheetLayout layout = best_layout(static_cast<int>(panels.size()), panels.front().size());
  Drawing drawing;
  drawing.width = layout.width(), drawing.height = layout.height();
  drawing.pixels_per_point = 1;
  drawing.paint = [&](Canvas& canvas) {
    for (int i = 0; i < static_cast<int>(panels.size()); ++i) {
      const Image& panel = panels[static_cast<std::size_t>(i)];
      const double left = kGap + i % layout.columns * (layout.panel.width + kGap),
                   top = i / layout.columns * (layout.panel.height + kTitleHeight + kGap);
      canvas.text(
          pictures[static_cast<std::size_t>(i)].title, {left, top + 2}, {.size = kTitleSize}
      );
      const double width = panel.width(), height = panel.height();
      canvas.picture(panel, {left, top + kTitleHeight, width, height});
    }
  };
  return draw_image(drawing);
}

}  // namespace

GLINT_PROVIDE(frame_sheet, draw_frame_sheet)

}  // namespace glint
