// SPDX-License-Identifier: MIT
// Pictures as a camera would clip them (clip_at_white_kernels.h). Beyond the paper.
#pragma once

#include "glint/render/map_ops.h"
#include "glint/train/clip_at_white_kernels.h"

namespace glint {

class WhiteClip {
 public:
  // [H][W][3] the picture, no brighter than what it is held to where the photo is white. Valid
  // until the next call.
  const Image& clip(const Image& image, const Image& photo, const Image& target) {
    fit(clipped_, image.size(), 3);
    run_kernel(
        3 * image.num_pixels(),
        kGrain,
        ClipAtWhite{image.on_device(), photo.on_device(), target.on_device(), clipped_.on_device()}
    );
    return clipped_;
  }
  // From the gradient of clip() to that of `image`, in place.
  void vjp(const Image& image, const Image& photo, const Image& target, Image& gradient) const {
    run_kernel(
        3 * image.num_pixels(),
        kGrain,
        ClipAtWhiteVjp{
            image.on_device(), photo.on_device(), target.on_device(), gradient.on_device()}
    );
  }

 private:
  static constexpr std::size_t kGrain = 4096;  // numbers a block
  Image clipped_;
};

}  // namespace glint
