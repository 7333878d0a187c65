// SPDX-License-Identifier: MIT
#include "datasets/glassroom/contact_sheet.h"

#include <algorithm>
#include <vector>

#include "datasets/glassroom/write_scene.h"
#include "drawing/color_maps.h"
#include "glint/scene/image_files.h"

namespace glint {

namespace {

constexpr float kFarDepth = 6;  // metres, end of the depth colours

Image glass_over_image(const MaskImage& glass, const Image& picture) {
  Image result = picture;
  for (std::size_t i = 0; i < glass.values().size(); ++i)
    if (glass.values()[i] == 0)
      for (std::size_t c = 0; c < 3; ++c) result.values()[3 * i + c] *= 0.15f;
  return result;
}

struct SheetRow {
  const char* title;
  Image picture;
};

std::vector<SheetRow> rows_of(const PathTracerOutput& truth, const Priors& priors, float exposure) {
  const Image picture = display_image(truth.radiance, exposure);
  return {
      {"image", picture},
      {"depth", colorize_depth(truth.depth, 0, kFarDepth)},
      {"normal", colorize_normal(truth.normal)},
      {"glass", glass_over_image(truth.glass, picture)},
      {"depth behind\nglass", colorize_depth(truth.behind_depth, 0, kFarDepth)},
      {"seen through\nglass", display_image(truth.transmitted, exposure)},
      {"mirrored\nby glass", display_image(truth.reflected, exposure)},
      {"normal prior,\nsimulated", colorize_normal(priors.normal)},
      {"albedo prior,\nsimulated", priors.albedo}};
}

}  // namespace

ContactSheet::ContactSheet(int views, int columns, ImageSize tile)
    : views_(views), columns_(std::min(views, columns)), tile_(tile) {
  for (int column = 0; column < columns_; ++column)
    grid_.titles.push_back("view " + view_name(column * views_ / columns_));
  grid_.legend = {
      {"depth: 0 m", LegendBar::kDepth, fmt::format("{:g} m, black: nothing", kFarDepth)}};
}

void ContactSheet::add(
    int view, const PathTracerOutput& truth, const Priors& priors, float exposure
) {
  // Column c shows view c * views / columns; this is the only c that can show `view`.
  const int column = (view * columns_ + views_ - 1) / views_;
  if (column >= columns_ || column * views_ / columns_ != view) return;
  const std::vector<SheetRow> rows = rows_of(truth, priors, exposure);
  grid_.rows.resize(rows.size(), std::vector<Image>(static_cast<std::size_t>(columns_)));
  grid_.row_titles.clear();
  for (std::size_t row = 0; row < rows.size(); ++row) {
    grid_.row_titles.emplace_back(rows[row].title);
    grid_.rows[row][static_cast<std::size_t>(column)] = resize_image(rows[row].picture, tile_);
  }
}

}  // namespace glint
