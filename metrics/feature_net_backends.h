// SPDX-License-Identifier: MIT
// What the libraries behind feature_net.h share.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "metrics/feature_net.h"

namespace glint::detail {

std::unique_ptr<FeatureNet> make_onednn_net(const std::vector<FeatureStep>& steps, ImageSize size);
// Null: built without cuDNN. Arrays are the GPU's. Errors (kEnvironment): what cuDNN reports.
std::unique_ptr<FeatureNet> make_cudnn_net(const std::vector<FeatureStep>& steps, ImageSize size);

std::string onednn_version();
std::string cudnn_version();  // empty: built without cuDNN

// Of a step's output, its windows rounded as the step says; 0 where none fits.
ImageSize out_size(ImageSize size, const FeatureStep& step);
// Throws (kBadReference) where none fits.
ImageSize checked_out_size(ImageSize size, const FeatureStep& step);
// How far windows reach beyond the end of the image: {width, height}.
ImageSize end_padding(ImageSize in, ImageSize out, const FeatureStep& step);

}  // namespace glint::detail
