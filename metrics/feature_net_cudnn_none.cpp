// SPDX-License-Identifier: MIT
// Where cuDNN was not found.
#include "metrics/feature_net_backends.h"

namespace glint {

std::unique_ptr<FeatureNet> detail::make_cudnn_net(const std::vector<FeatureStep>&, ImageSize) {
  return nullptr;
}
std::string detail::cudnn_version() { return {}; }

}  // namespace glint
