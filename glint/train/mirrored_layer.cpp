// SPDX-License-Identifier: MIT
#include "glint/train/mirrored_layer.h"

#include "glint/render/map_ops.h"

namespace glint {

void MirroredLayer::trace(
    const GlassBuffer& buffer,
    TrainableSet& set,
    int sh_degree,
    const MirrorCutoffs& mirror,
    std::optional<int> step,
    Image& layer
) {
  observes_ = !step || mirror.observes(*step);
  const bool own = observes_ && mirror.observe_every > 0 && set.grows();
  chosen_ = step && mirror.shares() && !own;
  const RaySharing sharing{.below = mirror.share_below};
  const Rays& rays = chosen_ ? shared_.choose(buffer, sharing, *step) : buffer.reflected;
  const Image& color = set.trace(pass_, rays, sh_degree, mirror.settings(step.has_value())).color;
  if (chosen_)
    shared_.spread(color, layer);
  else
    copy_color(color, layer);
}

const Rays& MirroredLayer::trace_backward(TrainableSet& set, const Image& dL_dlayer) {
  if (chosen_)
    shared_.spread_vjp(dL_dlayer, dL_dtrace_.color);
  else
    copy_color(dL_dlayer, dL_dtrace_.color);
  return set.trace_backward(dL_dtrace_, pass_, observes_);
}

}  // namespace glint
