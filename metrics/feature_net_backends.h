// SPDX-License-Identifier: MIT
// The two kinds of nets behind feature_net.h, and what they share.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "glint/core/service.h"
#include "metrics/feature_net.h"

namespace glint {

// On the CPU; brought by the library onednn_networks.
inline constinit Service<std::unique_ptr<FeatureNet>(const std::vector<FeatureStep>&, ImageSize)>
    make_onednn_net{"networks by oneDNN", "use the full build"};
inline constinit Service<std::string()> onednn_version{"networks by oneDNN", "use the full build"};

namespace detail {

// By the kernels of feature_net_kernels.h, on either device.
std::unique_ptr<FeatureNet> make_own_net(const std::vector<FeatureStep>& steps, ImageSize size);

// Of a step's output, its windows rounded as the step says; 0 where none fits.
ImageSize out_size(ImageSize size, const FeatureStep& step);
// Throws (kBadReference) where none fits.
ImageSize checked_out_size(ImageSize size, const FeatureStep& step);
// How far windows reach beyond the end of the image: {width, height}.
ImageSize end_padding(ImageSize in, ImageSize out, const FeatureStep& step);

}  // namespace detail
}  // namespace glint
