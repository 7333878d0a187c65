// SPDX-License-Identifier: MIT
#include "metrics/feature_net.h"

#include <algorithm>

#include "glint/core/error.h"
#include "metrics/feature_net_backends.h"

namespace glint {
namespace {

int out_extent(int extent, const FeatureStep& step) {
  const int room = extent + 2 * step.padding - step.kernel;
  if (room < 0) return 0;
  return room / step.stride + 1;
}

int reach_beyond(int in, int out, const FeatureStep& step) {
  return std::max(0, (out - 1) * step.stride + step.kernel - step.padding - in);
}

}  // namespace

ImageSize detail::out_size(ImageSize size, const FeatureStep& step) {
  return {out_extent(size.width, step), out_extent(size.height, step)};
}

ImageSize detail::checked_out_size(ImageSize size, const FeatureStep& step) {
  const ImageSize out = out_size(size, step);
  GLINT_CHECK(
      out.width > 0 && out.height > 0,
      kBadReference,
      "image too small for LPIPS: {} x {} features are left for a window of {} x {}",
      size.width,
      size.height,
      step.kernel,
      step.kernel
  );
  return out;
}

ImageSize detail::end_padding(ImageSize in, ImageSize out, const FeatureStep& step) {
  return {reach_beyond(in.width, out.width, step), reach_beyond(in.height, out.height, step)};
}

bool feature_net_accepts(const std::vector<FeatureStep>& steps, ImageSize size) {
  for (const FeatureStep& step : steps) {
    size = detail::out_size(size, step);
    if (size.width < 1 || size.height < 1) return false;
  }
  return true;
}

std::unique_ptr<FeatureNet> make_feature_net(
    const std::vector<FeatureStep>& steps, ImageSize size
) {
  if (on_gpu() || !make_onednn_net.here()) return detail::make_own_net(steps, size);
  return make_onednn_net(steps, size);
}

std::string feature_net_libraries() {
  return onednn_version.here() ? "oneDNN " + onednn_version() + ", own kernels on a GPU"
                               : "own kernels";
}

}  // namespace glint
