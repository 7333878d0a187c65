// SPDX-License-Identifier: MIT
// Where mirrored rays stop, and which of them are traced.
#pragma once

#include "glint/render/shared_rays_kernels.h"
#include "glint/render/trace.h"

namespace glint {

// Deviation: in training mirrored rays stop earlier than rasterised ones (1e-4, 256 hits), for a
// new reflection set is a fog of faint surfels that would take hundreds of hits a ray. The hit that
// would take a ray below 0.02 is left out with all behind it: at most k_s times the transmittance
// before it of a pixel's light. Pictures that someone looks at, or that are scored, have rays to
// the end. And in training, 2x2 pixels that mirror little share a ray (SharedRays).
struct MirrorCutoffs {
  float transmittance = 0.02f;
  int hits = 64;
  float near = 0;
  float share_below = 0.2f;  // k_s
  // One traced ray of several pixels gets the sum of their gradients, so that the norm which asks
  // for more surfels grows with the pixels that share. While the set grows, one step in so many
  // has a ray for each pixel, and density control looks at those steps alone; 0: at all.
  int observe_every = 4;

  template <class V>
  void visit(V&& v) {
    v("mirror_transmittance", transmittance, "transmittance at which mirrored rays of training stop"
    );
    v("mirror_hits", hits, "most surfels that a mirrored ray of training meets");
    v("mirror_share_below",
      share_below,
      "k_s below which pixels of a block share a mirrored ray in training; 0: none do");
    v("mirror_observe_every",
      observe_every,
      "of a growing set, one step in so many shares no mirrored rays, and growth counts it alone; "
      "0: growth counts all steps, shared rays too");
    v("mirror_near", near, "metres that a mirrored ray passes before it meets any");
  }
  // One that shares rays, if any does.
  static constexpr int kSharingStep = 1;
  bool shares() const { return share_below > 0; }
  // Whether density control looks at this step, in which no ray is shared then.
  bool observes(int step) const {
    return !shares() || observe_every <= 0 || step % observe_every == 0;
  }
  // Of training, or of a picture for someone.
  TraceSettings settings(bool training) const {
    TraceSettings settings;
    settings.near = near;
    if (!training) return settings;
    settings.min_transmittance = transmittance;
    settings.max_hits = hits;
    return settings;
  }
};

}  // namespace glint
