// SPDX-License-Identifier: MIT
// Where a pane of glass is, by its outlines (beyond the paper). Priors call it dark and know how it
// lies, but not how far away it is, and photos draw its surfels to what they show there. Where its
// plane is right, all views see the same dark rectangle on it; where it is not, each sees another,
// and what fits them all holds much that is not dark.
#pragma once

#include "glint/scene/scene.h"
#include "glint/train/fit_planes.h"

namespace glint {

// What one view has at a pixel.
struct OutlinePixel {
  Vec3d eye, ray;  // world; metres, any length
  Vec3d normal;    // of the surface there, unit
  bool dark = false;
};

class PaneOutlines {
 public:
  explicit PaneOutlines(PlaneFit settings = {}) : settings_(settings) {}

  void add(const OutlinePixel& pixel) { pixels_.push_back(pixel); }
  // Of the pixels that see the rectangle's front, the share that is dark and lies so; none: 0.
  double agreement(const MirrorPlane& plane) const;
  // Moves a plane along its normal, by some of the settings' tolerances, to where outlines agree
  // best, fits the rectangle there and returns how well. 0, and nothing moved, where they do not
  // tell: where views see little of the outline, or there is no rectangle.
  double place(PlaneOfPoints& fitted) const;

 private:
  PlaneFit settings_;
  std::vector<OutlinePixel> pixels_;
};

}  // namespace glint
