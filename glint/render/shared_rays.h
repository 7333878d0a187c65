// SPDX-License-Identifier: MIT
// Mirrored rays that neighbours share: where little is mirrored, one pixel of a block of 2x2 is
// traced and the others take its radiance. Beyond the papers; for training, where the pixel is
// another one each step.
#pragma once

#include "glint/render/glass_transport.h"
#include "glint/render/shared_rays_kernels.h"

namespace glint {

class SharedRays {
 public:
  // The rays of a buffer, those that nobody needs without a direction. `step` chooses the pixel of
  // each block. What it returns stays valid until the next call.
  const Rays& choose(const GlassBuffer& buffer, const RaySharing& sharing, int step);
  // Of the last choice: radiance [H][W][3] of the rays to that of the pixels, and its gradient.
  void spread(const Image& traced, Image& color) const;
  void spread_vjp(const Image& dL_dcolor, Image& dL_dtraced) const;

 private:
  SharersOf sharers() const;

  ShareBlocks blocks_{};
  Rays rays_;
  Array<std::uint32_t> source_;
};

}  // namespace glint
