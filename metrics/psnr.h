// SPDX-License-Identifier: MIT
// Peak signal-to-noise ratio of an image with values in [0, 1].
#pragma once

#include "glint/core/config.h"
#include "glint/core/image.h"

namespace glint {

inline constexpr double kPsnrCapDb = 100;  // what identical images get, so that means stay finite

struct PsnrProtocol {
  bool clamp = true;       // the prediction, to [0, 1]
  bool eight_bit = false;  // round the prediction to n / 255, half to even, as a saved PNG is
  static constexpr double cap_db = kPsnrCapDb;
  template <class V>
  void visit(V&& v) {
    v("clamp", clamp, "clamp the prediction to [0, 1]");
    v("eight_bit", eight_bit, "round the prediction to n / 255, half to even");
    v("cap_db", cap_db, "value for identical images");
  }
};

PsnrProtocol psnr_8bit_protocol();

// Mean squared error over all channels of the pixels that count; channels weigh alike. Errors:
// kBadPrediction (size, value not finite), kBadReference (the same; a mask without a pixel).
double mse(
    ImageView prediction, ImageView reference, MaskView mask = {}, const PsnrProtocol& protocol = {}
);

// 10 log10(1 / mse), at most kPsnrCapDb.
double psnr_from_mse(double mse);

// One MSE over all channels of one image, in dB. Errors as mse().
double psnr(ImageView prediction, ImageView reference, MaskView mask = {});
// The same after rounding the prediction to 8 bits: the PSNR of the PNG that write_png() would
// save.
double psnr_8bit(ImageView prediction, ImageView reference, MaskView mask = {});

}  // namespace glint
