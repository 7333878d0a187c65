// SPDX-License-Identifier: MIT
// What a set of surfels shows in the mirrored rays of an interface, and the way back.
#pragma once

#include <optional>

#include "glint/render/shared_rays.h"
#include "glint/train/mirror_cutoffs.h"
#include "glint/train/trainable_set.h"

namespace glint {

class MirroredLayer {
 public:
  // Fills `layer` [H][W][3]. step: of training, in which rays stop early and pixels may share them;
  // none: a picture for someone.
  void trace(
      const GlassBuffer& buffer,
      TrainableSet& set,
      int sh_degree,
      const MirrorCutoffs& mirror,
      std::optional<int> step,
      Image& layer
  );
  // Back through the last trace() to the set. Returns the gradient of the pixels' rays.
  const Rays& trace_backward(TrainableSet& set, const Image& dL_dlayer);

 private:
  SharedRays shared_;
  TracePass pass_;
  bool chosen_ = false;   // its rays, by shared_; else each pixel has its own
  bool observes_ = true;  // density control, the last trace()
  TraceOutputGradient dL_dtrace_;
};

}  // namespace glint
