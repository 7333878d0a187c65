// SPDX-License-Identifier: MIT
#include "metrics/layers.h"

#include <algorithm>
#include <cmath>

#include "metrics/depth.h"

namespace glint {
namespace {

bool has_depth(ImageView map, std::size_t pixel) {
  return !map.empty() && std::isfinite(map.data[pixel]) &&
         static_cast<double>(map.data[pixel]) > DepthProtocol{}.min_depth;
}

bool is_set(ImageView mask, std::size_t pixel) { return !mask.empty() && mask.data[pixel] > 0.5f; }

std::size_t at(int layer) { return static_cast<std::size_t>(layer - 1); }

}  // namespace

bool TrueLayers::exists(int layer, std::size_t pixel) const {
  return has_depth(truth_[kLayerDepth[at(layer)]], pixel);
}

bool TrueLayers::is_glass(int layer, std::size_t pixel) const {
  if (layer == 1) return glass_.data[pixel] != 0;
  return is_set(truth_[kLayerGlass[at(layer)]], pixel);
}

bool TrueLayers::opens(int layer, std::size_t pixel) const {
  return is_glass(layer, pixel) || is_set(truth_[kLayerMirror[at(layer)]], pixel);
}

template <class F>
MaskImage TrueLayers::counted_where(F&& is_in) const {
  MaskImage mask(glass_.width, glass_.height, 1);
  for (std::size_t i = 0; i < mask.num_pixels(); ++i)
    mask.data()[i] = (counted_.empty() || counted_.data[i] != 0) && is_in(i) ? 255 : 0;
  return mask;
}

MaskImage TrueLayers::opening() const {
  return counted_where([&](std::size_t i) { return opens(1, i); });
}

MaskImage TrueLayers::seen(int layer) const {
  if (layer == 1) return opening();
  return counted_where([&](std::size_t i) {
    bool opened = false;
    for (int before = 1; before < layer; ++before) opened = opened || opens(before, i);
    return opened && exists(layer, i);
  });
}

MaskImage TrueLayers::behind_glass(int layer) const {
  return counted_where([&](std::size_t i) {
    bool behind = layer == 1;
    for (int before = 1; before < layer; ++before) behind = behind || is_glass(before, i);
    return behind && (layer == 1 || exists(layer, i));
  });
}

MaskImage TrueLayers::glass(int layer) const {
  return counted_where([&](std::size_t i) { return is_glass(layer, i); });
}

Image TrueLayers::opaque_depth() const {
  Image depth(glass_.width, glass_.height, 1);
  for (std::size_t i = 0; i < depth.num_pixels(); ++i) {
    int layer = 1;
    while (layer < kMaxLayers && exists(layer, i) && opens(layer, i)) ++layer;
    if (layer > 1 && exists(layer, i) && !opens(layer, i))
      depth.data()[i] = truth_[kLayerDepth[at(layer)]].data[i];
  }
  return depth;
}

ImageView predicted_layer_depth(const MapViews& rendered, int layer) {
  if (layer == 1) return rendered[kLayerDepth[0]];
  for (int k = layer; k > 1; --k)
    if (rendered.has(kLayerDepth[at(k)])) return rendered[kLayerDepth[at(k)]];
  return rendered["behind_depth"];
}

Image predicted_opaque_depth(const MapViews& rendered) {
  const bool layered = rendered.has(kLayerDepth[1]);
  const ImageView first = rendered[kLayerDepth[0]], behind = rendered["behind_depth"];
  const ImageView base = layered || behind.empty() ? first : behind;
  if (base.empty()) return {};
  Image depth(base.width, base.height, 1);
  std::copy_n(base.data, base.num_pixels(), depth.data());
  if (layered)
    for (const MapId id : kLayerDepth)  // the deepest comes last
      for (std::size_t i = 0; i < depth.num_pixels(); ++i)
        if (has_depth(rendered[id], i)) depth.data()[i] = rendered[id].data[i];
  return depth;
}

}  // namespace glint
