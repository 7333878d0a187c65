// SPDX-License-Identifier: MIT
// Photos end at white: where a value of one is white, a render that is brighter is right. Beyond
// the papers.
#pragma once

#include "glint/core/image.h"

namespace glint {

class ClippedPhoto {
 public:
  static constexpr float kWhite = 0.995f;  // and above, as displayed

  // Both [H][W][3]. The render, its values above those of the photo's that are white lowered to
  // them; valid until the next call. Errors (kUsage): sizes differ.
  const Image& clip(const Image& rendered, const Image& photo);
  // Of the last clip(): values that were lowered have no gradient.
  static void clip_vjp(const Image& rendered, const Image& photo, Image& gradient);

 private:
  Image clipped_;
};

}  // namespace glint
