// SPDX-License-Identifier: MIT
#include "reports/bench/strip.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "glint/scene/image_files.h"
#include "reports/bench/run_folder.h"

namespace glint {

namespace {

using Panels = std::vector<Image>;

Image grey_panel(ImageSize size) { return Image(size.width, size.height, 3, 0.5f); }

Image error_panel(const Image& render, const Image& truth) {
  Image error(truth.width(), truth.height(), 3);
  for (std::size_t i = 0; i < error.values().size(); ++i)
    error.values()[i] =
        std::min(1.0f, kErrorGain * std::abs(render.values()[i] - truth.values()[i]));
  return error;
}

struct DepthRange {
  float low = 0, high = 1;
};

// 1 % to 99 % of the pixels that have depth.
DepthRange depth_range(const Image& depth) {
  std::vector<float> values;
  std::copy_if(
      depth.values().begin(),
      depth.values().end(),
      std::back_inserter(values),
      [](float z) { return std::isfinite(z) && z > 0; }
  );
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  return {values[values.size() / 100], values[values.size() - 1 - values.size() / 100]};
}

Image read_if_there(const fs::path& path) { return fs::exists(path) ? read_image(path) : Image(); }

Image depth_panel(const Image& depth, DepthRange range, ImageSize size) {
  return depth.empty() ? grey_panel(size) : colorize_depth(depth, range.low, range.high);
}

Image normal_panel(const Image& normal, ImageSize size) {
  return normal.empty() ? grey_panel(size) : colorize_normal(normal);
}

Panels panels_of(const fs::path& folder, const View& view) {
  const ImageSize size = view.rgb.size();
  const Image render = read_image(folder / "rgb.exr", 3);
  const Image depth = read_if_there(folder / "depth.exr");
  const Image normal = read_if_there(folder / "normal.exr");
  const DepthRange range = depth_range(view.truth.depth.empty() ? depth : view.truth.depth);
  return {
      view.rgb,
      render,
      error_panel(render, view.rgb),
      depth_panel(depth, range, size),
      depth_panel(view.truth.depth, range, size),
      normal_panel(normal, size),
      normal_panel(view.truth.normal, size)};
}

void paste(const Image& panel, int left, int top, Image& strip) {
  for (int y = 0; y < panel.height(); ++y)
    std::copy(
        panel.pixel(0, y),
        panel.pixel(0, y) + static_cast<std::ptrdiff_t>(panel.width()) * 3,
        strip.pixel(left, top + y)
    );
}

Image stacked(const std::vector<Panels>& rows) {
  int width = 0, height = 0;
  for (const Panels& row : rows) {
    width = std::max(width, row.front().width() * static_cast<int>(row.size()));
    height += row.front().height();
  }
  Image strip(width, height, 3, 0.5f);
  int top = 0;
  for (const Panels& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i)
      paste(row[i], static_cast<int>(i) * row.front().width(), top, strip);
    top += row.front().height();
  }
  return strip;
}

}  // namespace

void write_strip(const fs::path& run, const std::vector<View>& views) {
  std::vector<Panels> rows;
  const std::size_t count = std::min<std::size_t>(kStripViews, views.size());
  for (std::size_t i = 0; i < count; ++i) {
    const View& view = views[i * views.size() / count];
    rows.push_back(panels_of(view_folder(run, view.name), view));
  }
  if (!rows.empty()) write_png(run / "strip.png", stacked(rows));
}

}  // namespace glint
