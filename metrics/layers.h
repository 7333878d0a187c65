// SPDX-License-Identifier: MIT
// The surfaces along a ray in their order, of the truth and of a method.
#pragma once

#include "glint/core/image.h"
#include "glint/scene/layer_maps.h"

namespace glint {

// True layers 1 .. kMaxLayers. The maps outlive it; one that is absent says that no pixel has it.
class TrueLayers {
 public:
  // `glass`: of the first surface; `counted` as in metrics/metric.h: no other pixel is in a mask.
  TrueLayers(const MapViews& truth, MaskView glass, MaskView counted)
      : truth_(truth), glass_(glass), counted_(counted) {}

  // False: the truth has a first surface alone, or none, and nothing below may be asked.
  bool known() const {
    return truth_.has(kLayerDepth[0]) && truth_.has(kLayerDepth[1]) && !glass_.empty();
  }
  // Pixels whose first surface is glass or a mirror.
  MaskImage opening() const;
  // Those of a layer that lies behind a pane or in a mirror; of layer 1 opening().
  MaskImage seen(int layer) const;
  // Those of a layer that lies behind a pane; of layer 1 all.
  MaskImage behind_glass(int layer) const;
  MaskImage glass(int layer) const;
  // Of the first surface along the ray that is neither glass nor mirror; 0 where that is layer 1 or
  // beyond the last layer.
  Image opaque_depth() const;

 private:
  bool exists(int layer, std::size_t pixel) const;
  bool is_glass(int layer, std::size_t pixel) const;
  bool opens(int layer, std::size_t pixel) const;
  template <class F>
  MaskImage counted_where(F&& is_in) const;

  const MapViews& truth_;
  MaskView glass_, counted_;
};

// What a method is scored by at a layer: its map of it; of fewer layers the deepest one's; without
// any behind the first its "behind_depth". Empty: it has a first layer alone.
ImageView predicted_layer_depth(const MapViews& rendered, int layer);

// What a method is scored by at the first opaque surface: of several layers at each pixel the
// deepest that has a depth, down to "depth"; without any behind the first "behind_depth", else
// "depth". Empty: it renders none.
Image predicted_opaque_depth(const MapViews& rendered);

}  // namespace glint
