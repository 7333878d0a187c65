// SPDX-License-Identifier: MIT
#include "glint/train/clipped_photo.h"

#include "glint/train/check_fits.h"
#include "glint/train/clipped_photo_kernels.h"

namespace glint {

namespace {
constexpr std::size_t kGrain = 4096;  // values a block
}

const Image& ClippedPhoto::clip(const Image& rendered, const Image& photo) {
  check_fits("photo", photo, rendered.size(), 3);
  fit(clipped_, rendered.size(), 3);
  run_kernel(
      3 * rendered.num_pixels(),
      kGrain,
      ClipToPhoto{kWhite, rendered.on_device(), photo.on_device(), clipped_.on_device()}
  );
  return clipped_;
}

void ClippedPhoto::clip_vjp(const Image& rendered, const Image& photo, Image& gradient) {
  run_kernel(
      3 * rendered.num_pixels(),
      kGrain,
      ClipToPhotoVjp{kWhite, rendered.on_device(), photo.on_device(), gradient.on_device()}
  );
}

}  // namespace glint
