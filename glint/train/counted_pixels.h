// SPDX-License-Identifier: MIT
// Losses against a photo of which not all pixels count (View::counted). Where a pixel does not, the
// render is taken for right, in windows of its neighbours too, and gets no gradient.
#pragma once

#include "glint/render/map_ops.h"
#include "glint/scene/scene.h"
#include "glint/train/check_fits.h"
#include "glint/train/counted_kernels.h"

namespace glint {

// What a render is compared with; borrows both.
struct Photo {
  const Image& rgb;      // [H][W][3]
  const Image& counted;  // [H][W][1] 1: the pixel counts, 0: it does not; empty: all do

  Photo(const Image& image) : rgb(image), counted(all_pixels()) {}
  Photo(const Image& image, const Image& mask) : rgb(image), counted(mask) {}
  Photo(const View& view) : Photo(view.rgb, view.counted) {}

  bool all_count() const { return counted.empty(); }

 private:
  static const Image& all_pixels() {
    static const Image none;
    return none;
  }
};

class CountedPixels {
 public:
  // loss(picture, dL_dpicture), which adds to its second argument, for the pixels that count; what
  // it returns. Without a mask: of `rendered` and `gradient` themselves.
  template <class Loss>
  auto evaluate(const Image& rendered, const Photo& photo, Image& gradient, Loss&& loss) {
    if (photo.all_count()) return loss(rendered, gradient);
    check_fits("mask of pixels that count", photo.counted, rendered.size(), 1);
    fit(picture_, rendered.size(), 3);
    run_kernel(
        rendered.num_pixels(),
        kGrain,
        PutPhoto{
            photo.counted.on_device(),
            rendered.on_device(),
            photo.rgb.on_device(),
            picture_.on_device()}
    );
    clear_image(gradient_, rendered.size(), 3);
    const auto result = loss(picture_, gradient_);
    run_kernel(
        rendered.num_pixels(),
        kGrain,
        AddCounted{photo.counted.on_device(), gradient_.on_device(), gradient.on_device()}
    );
    return result;
  }

 private:
  static constexpr std::size_t kGrain = 4096;  // pixels a block

  Image picture_, gradient_;
};

}  // namespace glint
