// SPDX-License-Identifier: MIT
#include "reports/show/page/probe_values.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "reports/run/records/script_text.h"

namespace glint {

namespace {

// How the values of a layer are stored.
struct ProbeCodes {
  int bits;
  float high;  // 0: the largest value of the map
};

// Of pictures the image alone; errors follow from it.
std::optional<ProbeCodes> codes_of(const PageLayer& layer) {
  switch (layer.style) {
    case LayerStyle::kDepth:
      return ProbeCodes{16, 0};
    case LayerStyle::kAngle:
      return ProbeCodes{16, 180};
    case LayerStyle::kShare:
      return ProbeCodes{8, 1};
    default:
      return layer.id == "rgb" ? std::optional(ProbeCodes{8, 1}) : std::nullopt;
  }
}

std::vector<float> every_nth(const Image& map, int step) {
  std::vector<float> values;
  for (int y = 0; y < map.height(); y += step)
    for (int x = 0; x < map.width(); x += step)
      values.insert(values.end(), map.pixel(x, y), map.pixel(x, y) + map.channels());
  return values;
}

float largest(const std::vector<float>& values) {
  float high = 0;
  for (const float value : values)
    if (std::isfinite(value)) high = std::max(high, value);
  return high > 0 ? high : 1;
}

std::vector<std::uint8_t> codes8(const std::vector<float>& values, float high) {
  std::vector<std::uint8_t> codes;
  for (const float value : values) {
    const float share = std::isfinite(value) ? std::clamp(value / high, 0.0f, 1.0f) : 0.0f;
    codes.push_back(static_cast<std::uint8_t>(std::lround(share * 255)));
  }
  return codes;
}

// A finite value never becomes 0, which stands for "none"; depths of 0 are none.
std::vector<std::uint8_t> codes16(const std::vector<float>& values, float high, bool zero_is_none) {
  std::vector<std::uint8_t> codes(2 * values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool none = !std::isfinite(values[i]) || (zero_is_none && values[i] <= 0);
    const float share = none ? 0.0f : std::clamp(values[i] / high, 0.0f, 1.0f);
    const long code = none ? 0 : std::max(1L, std::lround(share * 65535));
    codes[i] = static_cast<std::uint8_t>(code & 255);
    codes[values.size() + i] = static_cast<std::uint8_t>(code >> 8);
  }
  return codes;
}

Json packed_layer(ProbeCodes layer, const Image& map, int step) {
  const std::vector<float> values = every_nth(map, step);
  const float high = layer.high > 0 ? layer.high : largest(values);
  const auto codes =
      layer.bits == 8 ? codes8(values, high) : codes16(values, high, layer.high <= 0);
  return {{"bits", layer.bits}, {"high", high}, {"data", packed(codes)}};
}

}  // namespace

int probe_step(ImageSize size) {
  int step = 1;
  while (size.num_pixels() / static_cast<std::size_t>(step * step) > kProbePixels) ++step;
  return step;
}

Json probe_values(const LayerMaps& maps, int step) {
  Json json = Json::object();
  for (const PageLayer& layer : page_layers())
    if (const auto codes = codes_of(layer))
      if (const auto it = maps.find(layer.id); it != maps.end())
        json[layer.id] = packed_layer(*codes, it->second, step);
  return json;
}

Json probe_glass(const MaskImage& glass) {
  if (glass.empty()) return nullptr;
  return packed(glass.values());
}

}  // namespace glint
