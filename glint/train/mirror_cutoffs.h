// SPDX-License-Identifier: MIT
// Where mirrored rays stop, and which of them are traced.
#pragma once

#include "glint/render/shared_rays_kernels.h"
#include "glint/render/trace.h"

namespace glint {

// Deviation: mirrored rays stop earlier than rasterised ones (1e-4, 256 hits). A new reflection set
// is a fog of faint surfels that would take hundreds of hits a ray, and what lies behind 2 % of
// transmittance changes a pixel by 0.02 k_s, less than a step of 8 bits at the k_s of glass. And in
// training, 2x2 pixels that mirror little share a ray, and such a ray may end earlier (SharedRays;
// off, docs/GLINT_NOTES.md says what it costs; as it does of larger blocks).
struct MirrorCutoffs {
  float transmittance = 0.02f;
  int hits = 64;
  float near = 0;
  float share_below = 0.2f;  // k_s
  int share_block = 2;       // pixels across and down
  float weight_below = 0;    // transmittance times k_s

  template <class V>
  void visit(V&& v) {
    v("mirror_transmittance", transmittance, "transmittance at which mirrored rays stop");
    v("mirror_hits", hits, "most surfels a mirrored ray meets");
    v("mirror_share_below",
      share_below,
      "k_s below which pixels of a block share a mirrored ray in training; 0: none do");
    v("mirror_share_block", share_block, "pixels across and down that share a mirrored ray");
    v("mirror_weight_below",
      weight_below,
      "transmittance times k_s below which mirrored rays end in training; 0: all at "
      "mirror_transmittance");
    v("mirror_near", near, "metres that a mirrored ray passes before it meets any");
  }
  RaySharing sharing() const { return {.below = share_below, .block = share_block}; }
  RayStops stops() const { return {.weight_below = weight_below, .latest = transmittance}; }
  TraceSettings settings() const {
    TraceSettings settings;
    settings.min_transmittance = transmittance;
    settings.max_hits = hits;
    settings.near = near;
    return settings;
  }
};

}  // namespace glint
