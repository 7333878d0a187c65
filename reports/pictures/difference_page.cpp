// SPDX-License-Identifier: MIT
#include "reports/pictures/difference_page.h"

#include "glint/drawing/picture_grid.h"
#include "glint/scene/image_files.h"

namespace glint {

namespace {

void draw_difference_page(const fs::path& picture, const DifferencePage& page) {
  PictureGrid grid{{"first", "second", "second / first - 1"}, {}, {}};
  for (const DifferenceRow& row : page.rows) {
    grid.row_titles.push_back(row.view);
    grid.rows.push_back({fit_panel(row.first), fit_panel(row.second), fit_panel(row.difference)});
  }
  grid.legend = {
      {"first: " + page.first},
      {"second: " + page.second},
      {fmt::format("second / first - 1, means over 5 x 5 pixels: -{:g} and less", page.range),
       LegendBar::kSigned,
       fmt::format("{:g} and more", page.range)}};
  write_png(picture, draw_bytes(draw_grid(std::move(grid))));
}

}  // namespace

GLINT_PROVIDE(write_difference_page, draw_difference_page)

}  // namespace glint
