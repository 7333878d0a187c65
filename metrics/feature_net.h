// SPDX-License-Identifier: MIT
// A chain of convolutions and poolings for images of one size, forwards and backwards. Features are
// [H][W][channels]; one image at a time, so that the largest network fits beside a training and
// every core works on the one that is waited for.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "glint/core/image.h"
#include "glint/core/service.h"
#include "metrics/lpips_weights.h"

namespace glint {

class FeatureNet {
 public:
  virtual ~FeatureNet() = default;

  virtual ImageSize size() const = 0;
  // [H][W][3], to be filled before forward().
  virtual ImageRef input() = 0;
  virtual void forward() = 0;

  // After forward(), which the next forward() overwrites.
  virtual std::size_t num_taps() const = 0;
  virtual ImageView tap(std::size_t index) const = 0;

  // dL/dinput of the last forward(), valid until the next call. `add_tap_gradient(index, dL_dtap)`
  // adds to the gradient of that tap; called once each, the last tap first.
  using AddTapGradient = std::function<void(std::size_t, ImageRef)>;
  virtual ImageView backward(const AddTapGradient& add_tap_gradient) = 0;
};

// Whether something is left of images of that size at the end of the chain.
bool feature_net_accepts(const std::vector<FeatureStep>& steps, ImageSize size);

// On a GPU in use by cuDNN where this program was built with it; otherwise, and with a warning
// where cuDNN fails, by oneDNN on the host. `steps` is not kept. Errors (kBadReference): images too
// small.
inline constinit Service<std::unique_ptr<FeatureNet>(const std::vector<FeatureStep>&, ImageSize)>
    make_feature_net{"LPIPS", "use the full build"};

// "oneDNN 2.7.2, cuDNN 9.1.0 on a GPU".
inline constinit Service<std::string()> feature_net_libraries{"LPIPS", "use the full build"};

}  // namespace glint
