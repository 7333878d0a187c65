// SPDX-License-Identifier: MIT
#include "reports/show/pictures/relit.h"

#include <algorithm>

#include "glint/render/transport.h"

namespace glint {

namespace {

constexpr float kGlass = 0.5f;  // t of a pane

Vec3f color_at(const Image& image, std::size_t i) {
  const float* c = image.data() + 3 * i;
  return {c[0], c[1], c[2]};
}

bool shows(const MapSet& maps, MapId id) { return maps.has(id) && maps[id].channels() == 3; }
bool has_reflection(const MapSet& maps) {
  return shows(maps, "interface") && shows(maps, "reflection") && maps.has("specularity");
}
bool has_transmission(const MapSet& maps) {
  return shows(maps, "interface") && shows(maps, "transmission") && maps.has("transparency");
}

// The layers of pixels; what a method has not counts as none.
class Layers {
 public:
  explicit Layers(const MapSet& maps)
      : maps_(maps), mirrors_(has_reflection(maps)), lets_through_(has_transmission(maps)) {}

  GlassRadiance<float> at(std::size_t i) const {
    GlassRadiance<float> layers{color_at(maps_["interface"], i), {}, {}, 0, 0};
    if (lets_through_) {
      layers.transmission = color_at(maps_["transmission"], i);
      layers.transparency = maps_["transparency"].data()[i];
    }
    if (mirrors_) {
      layers.reflection = color_at(maps_["reflection"], i);
      layers.mirrored = maps_["specularity"].data()[i];
    }
    return layers;
  }

 private:
  const MapSet& maps_;
  bool mirrors_, lets_through_;
};

GlassRadiance<float> scaled(GlassRadiance<float> layers, const LightScales& scales) {
  layers.mirrored = std::min(1.0f, scales.reflection * layers.mirrored);
  layers.transmission = scales.transmission * layers.transmission;
  layers.transparency = std::min(1.0f, scales.transparency * layers.transparency);
  return layers;
}

void add(Vec3f color, Image& image, std::size_t i) {
  for (int c = 0; c < 3; ++c) image.data()[3 * i + static_cast<std::size_t>(c)] += color[c];
}

void scale_part(const MapSet& maps, MapId id, float scale, Image& picture) {
  if (!maps.has(id)) return;
  for (std::size_t i = 0; i < picture.num_pixels(); ++i)
    add((scale - 1) * color_at(maps[id], i), picture, i);
}

}  // namespace

std::vector<std::string> scales_of(const MapSet& maps) {
  std::vector<std::string> scales;
  if (has_reflection(maps) || maps.has("reflected")) scales.emplace_back("reflection");
  if (has_transmission(maps) || maps.has("transmitted")) scales.emplace_back("transmission");
  if (has_transmission(maps)) scales.emplace_back("transparency");
  return scales;
}

Image with_scales(const MapSet& maps, const LightScales& scales) {
  Image picture = maps["rgb"];
  if (scales == LightScales{}) return picture;
  if (!has_reflection(maps) && !has_transmission(maps)) {
    scale_part(maps, "reflected", scales.reflection, picture);
    scale_part(maps, "transmitted", scales.transmission, picture);
    return picture;
  }
  const Layers layers(maps);
  for (std::size_t i = 0; i < picture.num_pixels(); ++i) {
    const GlassRadiance<float> pixel = layers.at(i);
    add(outgoing_radiance(scaled(pixel, scales)) - outgoing_radiance(pixel), picture, i);
  }
  return picture;
}

Image without_glass(const MapSet& maps) {
  if (!has_transmission(maps)) return {};
  Image picture = maps["rgb"];
  for (std::size_t i = 0; i < picture.num_pixels(); ++i)
    if (maps["transparency"].data()[i] > kGlass) {
      const Vec3f behind = color_at(maps["transmission"], i);
      std::copy_n(&behind.x, 3, picture.data() + 3 * i);
    }
  return picture;
}

PageLayer layer_without_glass() { return {"away", "Glass taken away", LayerStyle::kPicture}; }

}  // namespace glint
