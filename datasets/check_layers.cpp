// SPDX-License-Identifier: MIT
#include "datasets/check_layers.h"

#include "glint/scene/layer_maps.h"

namespace glint {
namespace {

// Of one layer; 0 is the first.
struct LayerRows {
  explicit LayerRows(std::size_t k)
      : depth(kLayerDepth[k]), glass(kLayerGlass[k]), mirror(kLayerMirror[k]) {}
  MapId depth, glass, mirror;
};

// Edges of anti-aliased truth leave a few.
constexpr std::size_t kFewest = 200;  // as a part of the pixels
constexpr float kOrder = 1e-4f;       // relative

// Pixels of a layer that does not fit the one before it.
struct Misfits {
  std::size_t nearer = 0, behind_opaque = 0;
};

bool is_set(const Image& mask, std::size_t pixel) {
  return !mask.empty() && mask.values()[pixel] > 0.5f;
}

// `before` and `layer`: two that follow each other.
Misfits count_misfits(const MapSet& truth, const LayerRows& before, const LayerRows& layer) {
  Misfits misfits;
  const Image &near = truth[before.depth], &far = truth[layer.depth];
  const bool knows_kind = truth.has(before.glass) || truth.has(before.mirror);
  for (std::size_t i = 0; i < far.num_pixels(); ++i) {
    const float z = far.values()[i];
    if (z == 0) continue;
    const bool passes = is_set(truth[before.glass], i) || is_set(truth[before.mirror], i);
    if (near.values()[i] == 0 || (knows_kind && !passes))
      ++misfits.behind_opaque;
    else if (z < (1 - kOrder) * near.values()[i])
      ++misfits.nearer;
  }
  return misfits;
}

bool are_comparable(const MapSet& truth, const LayerRows& before, const LayerRows& layer) {
  const ImageSize size = truth[layer.depth].size();
  if (!truth.has(layer.depth) || truth[before.depth].size() != size) return false;
  for (const MapId mask : {before.glass, before.mirror})
    if (truth.has(mask) && truth[mask].size() != size) return false;
  return true;
}

}  // namespace

bool is_of_layers(const MapRow& row) {
  return is_layer_map(row) || MapId(row) == kLayerDepth[0] || MapId(row) == kLayerGlass[0];
}

void check_layers(const ViewSource& view, const MapSet& truth, std::vector<Finding>& findings) {
  for (std::size_t k = 1; k < kMaxLayers; ++k) {
    const LayerRows before(k - 1), layer(k);
    if (!are_comparable(truth, before, layer)) continue;
    const Misfits misfits = count_misfits(truth, before, layer);
    const std::size_t most = truth[layer.depth].num_pixels() / kFewest;
    const std::string where = view.truth[layer.depth].string();
    if (misfits.nearer > most)
      findings.push_back(
          {"layer-order",
           where,
           fmt::format(
               "{} pixels of layer {} are nearer than layer {}; expected the surfaces along a ray "
               "in their order",
               misfits.nearer,
               k + 1,
               k
           )}
      );
    if (misfits.behind_opaque > most)
      findings.push_back(
          {"layer-behind-opaque",
           where,
           fmt::format(
               "{} pixels of layer {} lie behind what is neither glass nor a mirror in layer {}; "
               "expected 0 there",
               misfits.behind_opaque,
               k + 1,
               k
           )}
      );
  }
}

}  // namespace glint
