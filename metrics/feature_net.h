// SPDX-License-Identifier: MIT
// A chain of convolutions and poolings for images of one size, forwards and backwards. Features are
// [H][W][channels]; one image at a time, so that the largest network fits beside a training and
// every core works on the one that is waited for. All pictures are where ops run.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "glint/core/image.h"
#include "metrics/lpips_weights.h"

namespace glint {

class FeatureNet {
 public:
  virtual ~FeatureNet() = default;

  virtual ImageSize size() const = 0;
  // Runs on images of another size from now on. False: make another net. Errors (kBadReference):
  // images too small.
  virtual bool fit(ImageSize) { return false; }
  // [H][W][3 or more], of which the first three are to be filled before forward().
  virtual ImageRef input() = 0;
  virtual void forward() = 0;

  // After forward(), which the next forward() overwrites. Channels behind those of the step are
  // zero.
  virtual std::size_t num_taps() const = 0;
  virtual ImageView tap(std::size_t index) const = 0;

  // dL/dinput of the last forward(), valid until the next call. `add_tap_gradient(index, dL_dtap)`
  // adds to the gradient of that tap; called once each, the last tap first.
  using AddTapGradient = std::function<void(std::size_t, ImageRef)>;
  virtual ImageView backward(const AddTapGradient& add_tap_gradient) = 0;
};

// Whether something is left of images of that size at the end of the chain.
bool feature_net_accepts(const std::vector<FeatureStep>& steps, ImageSize size);

// For the device in use: by oneDNN on the CPU of a program that has it, otherwise by kernels of our
// own. `steps` is not kept. Errors (kBadReference): images too small.
std::unique_ptr<FeatureNet> make_feature_net(const std::vector<FeatureStep>& steps, ImageSize size);

// "oneDNN 2.7.2, own kernels on a GPU".
std::string feature_net_libraries();

}  // namespace glint
