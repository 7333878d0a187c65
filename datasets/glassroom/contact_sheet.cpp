// SPDX-License-Identifier: MIT
#include "datasets/glassroom/contact_sheet.h"

#include <algorithm>
#include <vector>

#include "datasets/glassroom/write_scene.h"
#include "glint/scene/image_files.h"

namespace glint {

namespace {

constexpr int kGap = 2;  // pixels between tiles
constexpr int kRows = 9;
constexpr float kFarDepth = 6;  // metres, end of the depth colours

Image glass_over_image(const MaskImage& glass, const Image& picture) {
  Image result = picture;
  for (std::size_t i = 0; i < glass.values().size(); ++i)
    if (glass.values()[i] == 0)
      for (std::size_t c = 0; c < 3; ++c) result.values()[3 * i + c] *= 0.15f;
  return result;
}

}  // namespace

ContactSheet::ContactSheet(int views, int columns, ImageSize tile)
    : views_(views),
      columns_(std::min(views, columns)),
      tile_(tile),
      image_(columns_ * (tile.width + kGap) - kGap, kRows * (tile.height + kGap) - kGap, 3, 1.0f) {}

void ContactSheet::add(
    int view, const PathTracerOutput& truth, const Priors& priors, float exposure
) {
  // Column c shows view c * views / columns; this is the only c that can show `view`.
  const int column = (view * columns_ + views_ - 1) / views_;
  if (column >= columns_ || column * views_ / columns_ != view) return;
  const Image picture = display_image(truth.radiance, exposure);
  const std::vector<Image> rows{
      picture,
      colorize_depth(truth.depth, 0, kFarDepth),
      colorize_normal(truth.normal),
      glass_over_image(truth.glass, picture),
      colorize_depth(truth.behind_depth, 0, kFarDepth),
      display_image(truth.transmitted, exposure),
      display_image(truth.reflected, exposure),
      colorize_normal(priors.normal),
      priors.albedo,
  };
  for (int row = 0; row < kRows; ++row) paste(column, row, rows[static_cast<std::size_t>(row)]);
}

void ContactSheet::paste(int column, int row, ImageView picture) {
  const Image tile = resize_image(picture, tile_);
  const int x0 = column * (tile_.width + kGap), y0 = row * (tile_.height + kGap);
  for (int y = 0; y < tile_.height; ++y)
    std::copy_n(tile.pixel(0, y), 3 * tile_.width, image_.pixel(x0, y0 + y));
}

}  // namespace glint
