// SPDX-License-Identifier: MIT
#include "glint/scene/maps.h"

#include <algorithm>

namespace glint {

namespace {

std::vector<MapRow>& table() {
  static std::vector<MapRow> rows(kMaps.begin(), kMaps.end());
  return rows;
}

}  // namespace

std::span<const MapRow> maps() { return table(); }

MapId::MapId(const MapRow& row)
    : index_(static_cast<std::size_t>(find_map(row.id) - maps().data())) {}

const MapRow* find_map(std::string_view id) {
  const auto rows = maps();
  const auto found =
      std::find_if(rows.begin(), rows.end(), [&](const MapRow& row) { return row.id == id; });
  return found == rows.end() ? nullptr : &*found;
}

std::string true_map_file(const MapRow& row, const std::string& view) {
  return std::string(row.truth) + "/" + view + (row.kind == MapKind::kMask ? ".png" : ".exr");
}

const MapRow* depth_of(const MapRow& normal) {
  constexpr std::string_view kNormal = "normal";
  if (!normal.id.ends_with(kNormal)) return nullptr;
  return find_map(std::string(normal.id.substr(0, normal.id.size() - kNormal.size())) + "depth");
}

MapViews views_of(const MapSet& maps) {
  MapViews views;
  maps.for_each([&](const MapRow& row, const Image& map) { views[row] = map; });
  return views;
}

Image map_of_mask(MaskView mask) {
  if (mask.empty()) return {};
  Image map(mask.width, mask.height, 1);
  for (std::size_t i = 0; i < map.num_pixels(); ++i)
    map.data()[i] = mask.data[i] != 0 ? 1.0f : 0.0f;
  return map;
}

MaskImage mask_of_map(ImageView map) {
  if (map.empty()) return {};
  MaskImage mask(map.width, map.height, 1);
  for (std::size_t i = 0; i < mask.num_pixels(); ++i) mask.data()[i] = map.data[i] > 0.5f ? 255 : 0;
  return mask;
}

ExtraMap::ExtraMap(const MapRow& row) { table().push_back(row); }
ExtraMap::~ExtraMap() { table().pop_back(); }

}  // namespace glint
