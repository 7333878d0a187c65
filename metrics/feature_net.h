// SPDX-License-Identifier: MIT
// A chain of convolutions and poolings for images of one size, forwards and backwards, by oneDNN.
// Features are [H][W][channels]; one image at a time, so that the largest network fits beside a
// training and every core works on the one that is waited for.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "glint/core/image.h"
#include "metrics/lpips_weights.h"

namespace glint {

class FeatureNet {
 public:
  // Whether something is left of images of that size at the end of the chain.
  static bool accepts(const std::vector<FeatureStep>& steps, ImageSize size);

  // `steps` is not kept. Errors (kBadReference): images too small for the chain.
  FeatureNet(const std::vector<FeatureStep>& steps, ImageSize size);
  ~FeatureNet();

  ImageSize size() const;
  // [H][W][3], to be filled before forward().
  ImageRef input();
  void forward();

  // After forward(), which the next forward() overwrites.
  std::size_t num_taps() const;
  ImageView tap(std::size_t index) const;

  // dL/dinput of the last forward(), valid until the next call. `add_tap_gradient(index, dL_dtap)`
  // adds to the gradient of that tap; called once each, the last tap first.
  ImageView backward(const std::function<void(std::size_t, ImageRef)>& add_tap_gradient);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint
