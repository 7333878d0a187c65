// SPDX-License-Identifier: MIT
#include "metrics/components.h"

#include <cmath>

#include "glint/core/error.h"
#include "glint/scene/layer_maps.h"

namespace glint {
namespace {

void check_radiance(ImageView displayed, ImageView radiance) {
  GLINT_CHECK(
      radiance.size() == displayed.size() && radiance.channels == displayed.channels,
      kBadReference,
      "radiance component has {} x {} pixels with {} channels, the image {} x {} with {}",
      radiance.width,
      radiance.height,
      radiance.channels,
      displayed.width,
      displayed.height,
      displayed.channels
  );
  for (int y = 0; y < radiance.height; ++y)
    for (int x = 0; x < radiance.width; ++x)
      for (int c = 0; c < radiance.channels; ++c)
        GLINT_CHECK(
            std::isfinite(radiance.at(x, y, c)) && radiance.at(x, y, c) >= 0,
            kBadReference,
            "radiance component: value {} at pixel ({}, {}); expected 0 or more",
            radiance.at(x, y, c),
            x,
            y
        );
}

}  // namespace

Image displayed_component(ImageView displayed, ImageView component, ImageView other) {
  check_radiance(displayed, component);
  check_radiance(displayed, other);
  Image result(displayed.width, displayed.height, displayed.channels);
  for (std::size_t i = 0; i < result.values().size(); ++i) {
    const double part = static_cast<double>(component.data[i]);
    const double sum = part + static_cast<double>(other.data[i]);
    const double share = sum > 0 ? part / sum : 0.0;
    result.data()[i] = static_cast<float>(share * static_cast<double>(displayed.data[i]));
  }
  return result;
}

std::vector<MapId> other_parts(const MapRow& part) {
  std::vector<MapId> others;
  for (const MapRow& row : maps())
    if (row.kind == MapKind::kPart && !row.truth.empty() && row.id != part.id &&
        is_path_map(row) == is_path_map(part))
      others.emplace_back(row);
  return others;
}

Image displayed_part(ImageView displayed, const MapViews& truth, MapId part) {
  Image others(displayed.width, displayed.height, displayed.channels);
  if (!truth.has(part)) return {};
  for (const MapId id : other_parts(part.row())) {
    if (!truth.has(id)) return {};
    check_radiance(displayed, truth[id]);
    for (std::size_t i = 0; i < others.values().size(); ++i) others.data()[i] += truth[id].data[i];
  }
  return displayed_component(displayed, truth[part], others);
}

}  // namespace glint
