// SPDX-License-Identifier: MIT
#include "datasets/glassroom/contact_sheet.h"

#include <algorithm>
#include <vector>

#include "datasets/glassroom/write_scene.h"
#include "glint/scene/image_files.h"

namespace glint {

namespace {

constexpr int kGap = 2;         // pixels between tiles
constexpr float kFarDepth = 6;  // metres, end of the depth colours

bool is_shown(const MapRow& row, bool truth) { return !(truth ? row.truth : row.prior).empty(); }

int num_rows() {
  int rows = 1;  // the image
  for (const bool truth : {true, false})
    for (const MapRow& row : maps()) rows += is_shown(row, truth) ? 1 : 0;
  return rows;
}

Image mask_over_image(const Image& mask, const Image& picture) {
  Image result = picture;
  for (std::size_t i = 0; i < mask.values().size(); ++i)
    if (mask.values()[i] == 0)
      for (std::size_t c = 0; c < 3; ++c) result.values()[3 * i + c] *= 0.15f;
  return result;
}

Image grey_picture(const Image& map) {
  Image picture(map.width(), map.height(), 3);
  for (std::size_t i = 0; i < picture.values().size(); ++i)
    picture.values()[i] = map.values()[i / 3];
  return picture;
}

}  // namespace

ContactSheet::ContactSheet(int views, int columns, ImageSize tile)
    : views_(views),
      columns_(std::min(views, columns)),
      tile_(tile),
      image_(
          columns_ * (tile.width + kGap) - kGap, num_rows() * (tile.height + kGap) - kGap, 3, 1.0f
      ) {}

void ContactSheet::add(
    int view, const PathTracerOutput& truth, const MapSet& priors, float exposure
) {
  // Column c shows view c * views / columns; this is the only c that can show `view`.
  const int column = (view * columns_ + views_ - 1) / views_;
  if (column >= columns_ || column * views_ / columns_ != view) return;
  const Image picture = display_image(truth.radiance, exposure);
  const auto picture_of = [&](MapKind kind, const Image& map, float far_depth) {
    if (kind == MapKind::kDepth) return colorize_depth(map, 0, far_depth);
    if (kind == MapKind::kNormal) return colorize_normal(map);
    if (kind == MapKind::kMask) return mask_over_image(map, picture);
    if (kind == MapKind::kPart) return display_image(map, exposure);
    return kind == MapKind::kShare ? grey_picture(map) : map;
  };
  int row = 0;
  paste(column, row++, picture);
  for (const bool is_truth : {true, false})
    for (const MapRow& entry : maps()) {
      if (!is_shown(entry, is_truth)) continue;
      const Image& map = (is_truth ? truth.maps : priors)[entry];
      const float far_depth = is_truth ? kFarDepth : 1;  // priors are relative
      if (!map.empty()) paste(column, row, picture_of(entry.kind, map, far_depth));
      ++row;
    }
}

void ContactSheet::paste(int column, int row, ImageView picture) {
  const Image tile = resize_image(picture, tile_);
  const int x0 = column * (tile_.width + kGap), y0 = row * (tile_.height + kGap);
  for (int y = 0; y < tile_.height; ++y)
    std::copy_n(tile.pixel(0, y), 3 * tile_.width, image_.pixel(x0, y0 + y));
}

}  // namespace glint
