// SPDX-License-Identifier: MIT
// In place of networks on oneDNN: none can be made, since no weights can be loaded either.
#include "glint/core/error.h"
#include "metrics/feature_net.h"

namespace glint {
namespace {

[[noreturn]] void fail() {
  throw Error(ExitCode::kEnvironment, "LPIPS needs the full build; this is a lean one");
}

}  // namespace

class FeatureNet::Impl {};

bool FeatureNet::accepts(const std::vector<FeatureStep>&, ImageSize) { return false; }
FeatureNet::FeatureNet(const std::vector<FeatureStep>&, ImageSize) { fail(); }
FeatureNet::~FeatureNet() = default;

ImageSize FeatureNet::size() const { fail(); }
ImageRef FeatureNet::input() { fail(); }
void FeatureNet::forward() { fail(); }
std::size_t FeatureNet::num_taps() const { fail(); }
ImageView FeatureNet::tap(std::size_t) const { fail(); }
ImageView FeatureNet::backward(const std::function<void(std::size_t, ImageRef)>&) { fail(); }

}  // namespace glint
