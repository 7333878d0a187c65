// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "datasets/counted_pixels.h"
#include "datasets/map_resize.h"
#include "datasets/view_maps.h"
#include "glint/scene/image_files.h"

namespace glint {
namespace {

Image resize_map(const Image& map, MapKind kind, ImageSize size) {
  if (kind == MapKind::kDepth) return resize_depth(map, size);
  if (kind == MapKind::kNormal) return resize_normal(map, size);
  if (kind == MapKind::kMask) return map_of_mask(resize_mask(mask_of_map(map), size));
  return resize_image(map, size);
}

ImageSize target_size(ImageSize stored, const LoadOptions& options) {
  if (options.size.width > 0 && options.size.height > 0) return options.size;
  if (options.image_ratio < 1)
    return {
        std::max(1, static_cast<int>(options.image_ratio * stored.width)),
        std::max(1, static_cast<int>(options.image_ratio * stored.height))};
  const auto pixels = static_cast<double>(stored.num_pixels());
  if (options.max_pixels <= 0 || pixels <= options.max_pixels) return stored;
  const double scale = std::sqrt(options.max_pixels / pixels);
  return {
      std::max(1, static_cast<int>(scale * stored.width)),
      std::max(1, static_cast<int>(scale * stored.height))};
}

}  // namespace

void fit_view(View& view, const LoadOptions& options) {
  const ImageSize size = target_size(view.camera.size(), options);
  if (size == view.camera.size()) return;
  Image rgb;
  if (!view.counted.empty()) rgb = resize_counted(view.rgb, view.counted, size);
  for_each_map(view, [&](const std::string&, Image& map, const MapRow& row) {
    if (!map.empty()) map = resize_map(map, row.kind, size);
  });
  if (!rgb.empty()) view.rgb = std::move(rgb);
  view.camera = resized(view.camera, size);
}

}  // namespace glint
