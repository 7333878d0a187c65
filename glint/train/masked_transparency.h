// SPDX-License-Identifier: MIT
// Regulariser of the transparency map t as GLINT's second release has it, and not the paper: where
// labels of guidance say something, t is drawn to 0 or 1; where they say opaque, to 0; where they
// say glass, late in a run, above 0.8; and t is smooth but for edges of the photo.
#pragma once

#include "glint/train/transparency_guidance.h"
#include "glint/train/transparency_prior.h"

namespace glint {

// How far into its last stretch a run is: from 0 to 1, the entropy of pixels gives way to that of
// surfels (TrainableSet::penalise_entropy), the mean over what is opaque counts three times, and
// glass is held.
struct MaskedTransparencyRamp {
  float late = 0;
  float entropy() const { return 1 - late; }
  float opaque() const { return 1 + 2 * late; }
  float hinge() const { return late; }  // weight 1 is ours: the release's was not read
};

class MaskedTransparencyLoss {
 public:
  static constexpr float kLeastOnGlass = 0.8f;

  // transparency: t [H][W][1]; image: the photo [H][W][3]. Each term is the mean over its mask, 0
  // where that is empty; without masks at all only t's smoothness is left. Adds weight * gradient
  // to dL_dt and returns the unweighted loss.
  template <class T>
  double evaluate(
      const BasicImage<T>& transparency,
      const TransparencyMasks& masks,
      const Image& image,
      MaskedTransparencyRamp ramp,
      T weight,
      BasicImage<T>& dL_dt
  );

 private:
  Image labelled_;
};

}  // namespace glint
