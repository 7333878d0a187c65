// SPDX-License-Identifier: MIT
#include "metrics/psnr.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "metrics/reduce.h"

namespace glint {
namespace {

// The prediction's value as it is compared. Single precision, as write_png() rounds.
float compared(float value, const PsnrProtocol& protocol) {
  if (protocol.clamp || protocol.eight_bit) value = std::clamp(value, 0.0f, 1.0f);
  return protocol.eight_bit ? std::nearbyint(value * 255.0f) / 255.0f : value;
}

// Of `count` values. Several sums side by side, which the compiler makes one vector of.
double squared_error(
    const float* prediction, const float* reference, std::size_t count, const PsnrProtocol& protocol
) {
  constexpr std::size_t kLanes = 8;
  double sums[kLanes] = {};
  const auto add = [&](std::size_t i, std::size_t lane) {
    const double difference =
        static_cast<double>(compared(prediction[i], protocol)) - static_cast<double>(reference[i]);
    sums[lane] += difference * difference;
  };
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) add(i + lane, lane);
  for (; i < count; ++i) add(i, i % kLanes);
  return std::accumulate(sums, sums + kLanes, 0.0);
}

// Over the pixels of a row that count, a run of them at a time; `count` of Sum is in pixels.
Sum squared_error_of_row(
    ImageView prediction, ImageView reference, MaskView mask, int y, const PsnrProtocol& protocol
) {
  Sum sum;
  const auto channels = static_cast<std::size_t>(reference.channels);
  for (int begin = 0, end = 0; begin < reference.width; begin = end + 1) {
    for (end = begin; end < reference.width && counts(mask, end, y);) ++end;
    const auto pixels = static_cast<std::size_t>(end - begin);
    if (pixels == 0) continue;
    sum +=
        {squared_error(
             prediction.pixel(begin, y), reference.pixel(begin, y), pixels * channels, protocol
         ),
         pixels};
  }
  return sum;
}

// All values are looked at, those that a mask leaves out too.
bool row_is_finite(ImageView image, int y) {
  return all_finite({image.pixel(0, y), static_cast<std::size_t>(image.width) * image.channels});
}

// Both in one pass over the pictures: what takes time is to fetch them.
struct RowsError {
  Sum sum;
  bool finite = true;

  RowsError& operator+=(const RowsError& other) {
    sum += other.sum;
    finite = finite && other.finite;
    return *this;
  }
};

}  // namespace

PsnrProtocol psnr_8bit_protocol() {
  PsnrProtocol protocol;
  protocol.eight_bit = true;
  return protocol;
}

double mse(ImageView prediction, ImageView reference, MaskView mask, const PsnrProtocol& protocol) {
  check_same_shape(prediction, reference, mask);
  const auto rows = sum_rows<RowsError>(reference.height, [&](int y) {
    const bool finite = row_is_finite(prediction, y) && row_is_finite(reference, y);
    return RowsError{squared_error_of_row(prediction, reference, mask, y, protocol), finite};
  });
  if (!rows.finite) {
    check_finite(prediction, ExitCode::kBadPrediction, "prediction");
    check_finite(reference, ExitCode::kBadReference, "reference");
  }
  GLINT_CHECK(rows.sum.count > 0, kBadReference, "mask without a pixel that counts");
  return *rows.sum.mean() / reference.channels;
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
