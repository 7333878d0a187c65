// SPDX-License-Identifier: MIT
// The convolutional networks of LPIPS [Zhang18] as chains of layers, with the names of
// torchvision's `features` (AlexNet, VGG16), up to the last layer that LPIPS looks at.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace glint {

// A convolution with bias, followed by ReLU, or the largest of each window.
struct LpipsLayer {
  std::string name;  // "features.3"; empty: pooling
  int channels = 0;  // of the output; 0: as the input
  int kernel = 3, stride = 1, padding = 0;
  bool tap = false;  // LPIPS compares its output

  bool pools() const { return name.empty(); }
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
LpipsLayer max_pool(int kernel, int stride);

// alex, vgg.
const std::vector<LpipsNetwork>& lpips_networks();

}  // namespace glint
