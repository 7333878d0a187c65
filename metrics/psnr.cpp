// SPDX-License-Identifier: MIT
#include "metrics/psnr.h"

#include <algorithm>
#include <cmath>

#include "metrics/reduce.h"

namespace glint {
namespace {

// The prediction's value as it is compared. Single precision, as write_png() rounds.
float compared(float value, const PsnrProtocol& protocol) {
  if (protocol.clamp || protocol.eight_bit) value = std::clamp(value, 0.0f, 1.0f);
  return protocol.eight_bit ? std::nearbyint(value * 255.0f) / 255.0f : value;
}

}  // namespace

PsnrProtocol psnr_8bit_protocol() {
  PsnrProtocol protocol;
  protocol.eight_bit = true;
  return protocol;
}

double mse(ImageView prediction, ImageView reference, MaskView mask, const PsnrProtocol& protocol) {
  check_same_shape(prediction, reference, mask);
  check_finite(prediction, ExitCode::kBadPrediction, "prediction");
  check_finite(reference, ExitCode::kBadReference, "reference");
  const Sum sum = sum_pixels(reference.size(), mask, [&](int x, int y) {
    const float *p = prediction.pixel(x, y), *r = reference.pixel(x, y);
    double squares = 0;
    for (int c = 0; c < reference.channels; ++c) {
      const double difference =
          static_cast<double>(compared(p[c], protocol)) - static_cast<double>(r[c]);
      squares += difference * difference;
    }
    return squares / reference.channels;
  });
  GLINT_CHECK(sum.count > 0, kBadReference, "mask without a pixel that counts");
  return *sum.mean();
}

double psnr_from_mse(double mse) {
  return mse > 0 ? std::min(kPsnrCapDb, -10 * std::log10(mse)) : kPsnrCapDb;
}

double psnr(ImageView prediction, ImageView reference, MaskView mask) {
  return psnr_from_mse(mse(prediction, reference, mask));
}

double psnr_8bit(ImageView prediction, ImageView reference, MaskView mask) {
  return psnr_from_mse(mse(prediction, reference, mask, psnr_8bit_protocol()));
}

}  // namespace glint
