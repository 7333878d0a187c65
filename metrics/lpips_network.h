// SPDX-License-Identifier: MIT
// The convolutional networks of LPIPS [Zhang18] as chains of layers, with the names of
// torchvision's `features` (AlexNet, SqueezeNet 1.1, VGG16), up to the last layer that LPIPS looks
// at.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace glint {

struct LpipsLayer {
  enum class Kind {
    kConvolution,  // with bias, followed by ReLU
    kFire,         // [Iandola16]: 1x1 squeeze, then 1x1 and 3x3 expansions side by side, ReLU each
    kMaxPool
  };
  Kind kind = Kind::kConvolution;
  std::string name;  // "features.3"; empty: pooling
  int channels = 0;  // of the output; 0: as the input
  int kernel = 3, stride = 1, padding = 0;
  int squeeze = 0;        // channels between (kFire)
  bool round_up = false;  // windows may leave the image at its end (kMaxPool)
  bool tap = false;       // LPIPS compares its output

  LpipsLayer tapped() const {
    LpipsLayer layer = *this;
    layer.tap = true;
    return layer;
  }
};

struct LpipsNetwork {
  std::string name;                // "alex"
  std::string title;               // "AlexNet"
  std::vector<LpipsLayer> layers;  // the last one is a tap
};

LpipsLayer convolution(std::string name, int channels, int kernel, int stride, int padding);
// `expand`: channels of each of the two expansions.
LpipsLayer fire(std::string name, int squeeze, int expand);
LpipsLayer max_pool(int kernel, int stride, bool round_up = false);

// alex, squeeze, vgg.
const std::vector<LpipsNetwork>& lpips_networks();

}  // namespace glint
