// SPDX-License-Identifier: MIT
// Structural similarity [Wang04] with an 11x11 Gaussian window, per channel, values in [0, 1].
#pragma once

#include <optional>

#include "glint/core/config.h"
#include "glint/core/image.h"
#include "glint/render/ssim_formula.h"

namespace glint {

// Where the window is evaluated. kZeroPadded: at every pixel, zeros outside the image (3DGS, 2DGS
// and their successors). kValid: only where the window lies inside (Wang; scikit-image with
// Gaussian weights, sigma 1.5, population covariance). Inside, both agree.
enum class SsimBorder { kZeroPadded, kValid };
NLOHMANN_JSON_SERIALIZE_ENUM(
    SsimBorder, {{SsimBorder::kZeroPadded, "zero padded"}, {SsimBorder::kValid, "valid region"}}
)

struct SsimProtocol {
  SsimBorder border = SsimBorder::kZeroPadded;
  static constexpr int window = kSsimTaps;
  static constexpr double sigma = kSsimSigma, c1 = kSsimC1, c2 = kSsimC2;
  static constexpr bool clamp = true;
  template <class V>
  void visit(V&& v) {
    v("border", border, "where the window is evaluated");
    v("window", window, "side in pixels");
    v("sigma", sigma, "of the Gaussian in pixels");
    v("c1", c1, "(0.01 range)^2, range 1");
    v("c2", c2, "(0.03 range)^2, range 1");
    v("clamp", clamp, "the prediction is clamped to [0, 1]");
  }
};

using SsimMap = BasicImage<double>;  // [H][W][1], mean over the channels

// SSIM at every pixel, zeros outside the image; the prediction clamped to [0, 1]. Errors as mse().
SsimMap ssim_map(ImageView prediction, ImageView reference);

// Mean of the map over the pixels of the mask where `border` lets the window be evaluated; empty
// when there are none.
std::optional<double> ssim_mean(const SsimMap& map, SsimBorder border, MaskView mask = {});

// Errors as mse(); kBadReference also when no pixel is left (image smaller than the window, mask at
// the image's edge only).
double ssim(ImageView prediction, ImageView reference, SsimBorder border, MaskView mask = {});
double ssim_3dgs(ImageView prediction, ImageView reference, MaskView mask = {});
double ssim_wang(ImageView prediction, ImageView reference, MaskView mask = {});

}  // namespace glint
