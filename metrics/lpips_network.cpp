// SPDX-License-Identifier: MIT
#include "metrics/lpips_network.h"

#include <utility>

namespace glint {
namespace {

using Layers = std::vector<LpipsLayer>;

// [Krizhevsky14], one tower.
Layers alex_layers() {
  const LpipsLayer pool = max_pool(3, 2);
  return {
      convolution("features.0", 64, 11, 4, 2).tapped(),
      pool,
      convolution("features.3", 192, 5, 1, 2).tapped(),
      pool,
      convolution("features.6", 384, 3, 1, 1).tapped(),
      convolution("features.8", 256, 3, 1, 1).tapped(),
      convolution("features.10", 256, 3, 1, 1).tapped()};
}

// [Simonyan15], configuration D.
Layers vgg_layers() {
  const LpipsLayer pool = max_pool(2, 2);
  const auto same = [](const char* name, int channels) {
    return convolution(name, channels, 3, 1, 1);
  };
  return {
      same("features.0", 64),
      same("features.2", 64).tapped(),
      pool,
      same("features.5", 128),
      same("features.7", 128).tapped(),
      pool,
      same("features.10", 256),
      same("features.12", 256),
      same("features.14", 256).tapped(),
      pool,
      same("features.17", 512),
      same("features.19", 512),
      same("features.21", 512).tapped(),
      pool,
      same("features.24", 512),
      same("features.26", 512),
      same("features.28", 512).tapped()};
}

}  // namespace

LpipsLayer convolution(std::string name, int channels, int kernel, int stride, int padding) {
  LpipsLayer layer;
  layer.name = std::move(name);
  layer.channels = channels;
  layer.kernel = kernel, layer.stride = stride, layer.padding = padding;
  return layer;
}

LpipsLayer max_pool(int kernel, int stride) { return convolution({}, 0, kernel, stride, 0); }

const std::vector<LpipsNetwork>& lpips_networks() {
  static const std::vector<LpipsNetwork> networks = {
      {"alex", "AlexNet", alex_layers()}, {"vgg", "VGG16", vgg_layers()}};
  return networks;
}

}  // namespace glint
