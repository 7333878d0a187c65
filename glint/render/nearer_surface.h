// SPDX-License-Identifier: MIT
// The surface that a ray meets behind a layer, of two sets: a pane that the interface set knows
// from other views, where it stands in front of what the transmission set has; else the latter.
// The choice has no gradient.
#pragma once

#include "glint/render/rasterize.h"

namespace glint {

class NearerSurface {
 public:
  // transparency: the feature that is t, of both. light [H][W][1]: share of the pixel's light that
  // gets there; where it is 0 the other set's surface is taken, with t = 0 and without a normal.
  // What it returns is valid until the next call; `light` must stay until pick_vjp().
  const RasterOutput& pick(
      const RasterOutput& panes, const RasterOutput& others, int transparency, const Image& light
  );
  // Assigns the gradients of both.
  void pick_vjp(
      const RasterOutputGradient& dL_dpicked,
      RasterOutputGradient& dL_dpanes,
      RasterOutputGradient& dL_dothers
  ) const;
  const RasterOutput& picked() const { return picked_; }
  const Image& is_pane() const { return is_pane_; }  // [H][W][1] 1: of the interface set

 private:
  RasterOutput picked_;
  Image is_pane_;
  int transparency_ = 0;
  const Image* light_ = nullptr;
};

}  // namespace glint
