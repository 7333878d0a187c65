// SPDX-License-Identifier: MIT
#include "datasets/glassroom/contact_sheet.h"

#include <algorithm>
#include <vector>

#include "datasets/glassroom/write_scene.h"
#include "glint/drawing/color_maps.h"
#include "glint/scene/image_files.h"

namespace glint {

namespace {

constexpr float kFarPrior = 1;  // priors are relative

// A row of the sheet: what is true, or what a simulated prior says.
bool is_shown(const MapRow& row, bool truth) { return !(truth ? row.truth : row.prior).empty(); }

std::string title_of(const MapRow& row, bool truth) {
  return fmt::format("{}\n({})", row.title, truth ? "true" : "simulated prior");
}

Image mask_over_image(const Image& mask, const Image& picture) {
  Image result = picture;
  for (std::size_t i = 0; i < mask.values().size(); ++i)
    if (mask.values()[i] == 0)
      for (std::size_t c = 0; c < 3; ++c) result.values()[3 * i + c] *= 0.15f;
  return result;
}

bool has_values(const Image& map) {
  return std::any_of(map.values().begin(), map.values().end(), [](float v) { return v != 0; });
}

// What the maps of one view are drawn with.
struct ViewPictures {
  Image image;  // as displayed
  float exposure;

  Image of(MapKind kind, const Image& map, float far_depth) const {
    switch (kind) {
      case MapKind::kDepth:
        return colorize_depth(map, 0, far_depth);
      case MapKind::kNormal:
        return colorize_normal(map);
      case MapKind::kMask:
        return mask_over_image(map, image);
      case MapKind::kPart:
        return display_image(map, exposure);
      case MapKind::kShare:
        return grey_picture(map);
      case MapKind::kColor:
        return map;
    }
    return map;
  }
};

}  // namespace

ContactSheet::ContactSheet(int views, int columns, ImageSize tile, float far_depth)
    : views_(views), columns_(std::min(views, columns)), tile_(tile), far_depth_(far_depth) {
  for (int column = 0; column < columns_; ++column)
    grid_.titles.push_back("view " + view_name(column * views_ / columns_));
  grid_.legend = {
      {"true depth: 0 m", LegendBar::kDepth, fmt::format("{:g} m, black: nothing", far_depth)},
      {"simulated depth prior: 0",
       LegendBar::kDepth,
       fmt::format("{:g}, without unit", kFarPrior)}};
}

void ContactSheet::add(
    int view, const PathTracerOutput& truth, const MapSet& priors, float exposure
) {
  // Column c shows view c * views / columns; this is the only c that can show `view`.
  const int column = (view * columns_ + views_ - 1) / views_;
  if (column >= columns_ || column * views_ / columns_ != view) return;
  const ViewPictures pictures{display_image(truth.radiance, exposure), exposure};
  std::size_t row = 0;
  const auto add_row = [&](const std::string& title, const Image& picture, bool says) {
    if (row == grid_.rows.size()) {
      grid_.rows.emplace_back(static_cast<std::size_t>(columns_));
      grid_.row_titles.push_back(title);
      says_anything_.push_back(false);
    }
    says_anything_[row] = says_anything_[row] || says;
    if (!picture.empty())
      grid_.rows[row][static_cast<std::size_t>(column)] = resize_image(picture, tile_);
    ++row;
  };
  add_row(std::string(MapId("rgb").row().title), pictures.image, true);
  for (const bool is_truth : {true, false})
    for (const MapRow& entry : maps()) {
      const Image& map = (is_truth ? truth.maps : priors)[entry];
      if (!is_shown(entry, is_truth) || map.empty()) continue;  // not made
      const float far_depth = is_truth ? far_depth_ : kFarPrior;
      const bool says = has_values(map);
      add_row(title_of(entry, is_truth), pictures.of(entry.kind, map, far_depth), says);
    }
}

ByteImage ContactSheet::image() const {
  PictureGrid shown = grid_;
  shown.rows.clear();
  shown.row_titles.clear();
  for (std::size_t row = 0; row < grid_.rows.size(); ++row) {
    if (!says_anything_[row]) continue;
    shown.rows.push_back(grid_.rows[row]);
    shown.row_titles.push_back(grid_.row_titles[row]);
  }
  return draw_bytes(draw_grid(shown));
}

}  // namespace glint
