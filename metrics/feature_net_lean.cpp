// SPDX-License-Identifier: MIT
// In place of networks: none can be made, since no weights can be loaded either.
#include "glint/core/error.h"
#include "metrics/feature_net.h"

namespace glint {

bool feature_net_accepts(const std::vector<FeatureStep>&, ImageSize) { return false; }
std::unique_ptr<FeatureNet> make_feature_net(const std::vector<FeatureStep>&, ImageSize) {
  throw Error(ExitCode::kEnvironment, "LPIPS needs the full build; this is a lean one");
}
std::string feature_net_libraries() { return "none"; }

}  // namespace glint
