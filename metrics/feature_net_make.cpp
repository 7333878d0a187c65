// SPDX-License-Identifier: MIT
// Networks by cuDNN or oneDNN: what the library lpips_networks brings.
#include "glint/core/device.h"
#include "glint/core/error.h"
#include "glint/core/progress.h"
#include "metrics/feature_net_backends.h"

namespace glint {
namespace {

std::unique_ptr<FeatureNet> make_net(const std::vector<FeatureStep>& steps, ImageSize size) {
  try {
    if (on_gpu())
      if (auto net = detail::make_cudnn_net(steps, size)) return net;
  } catch (const Error& error) {
    if (error.code() != ExitCode::kEnvironment) throw;
    log::warn(std::string(error.what()) + "; its networks run on the host");
  }
  return detail::make_onednn_net(steps, size);
}

std::string libraries() {
  const std::string cudnn = detail::cudnn_version();
  return "oneDNN " + detail::onednn_version() +
         (cudnn.empty() ? std::string() : ", cuDNN " + cudnn + " on a GPU");
}

}  // namespace

GLINT_PROVIDE(make_feature_net, make_net)
GLINT_PROVIDE(feature_net_libraries, libraries)

}  // namespace glint
