// SPDX-License-Identifier: MIT
#include "metrics/reduce.h"

namespace glint {

void check_same_shape(ImageView prediction, ImageView reference, MaskView mask) {
  GLINT_CHECK(
      prediction.num_pixels() > 0 && reference.num_pixels() > 0,
      kBadPrediction,
      "image without pixels"
  );
  GLINT_CHECK(
      prediction.size() == reference.size(),
      kBadPrediction,
      "prediction has {} x {} pixels, reference {} x {}; render at the reference's size",
      prediction.width,
      prediction.height,
      reference.width,
      reference.height
  );
  GLINT_CHECK(
      prediction.channels == reference.channels,
      kBadPrediction,
      "prediction has {} channels, reference {}",
      prediction.channels,
      reference.channels
  );
  GLINT_CHECK(
      mask.empty() || mask.size() == reference.size(),
      kBadReference,
      "mask has {} x {} pixels, reference {} x {}",
      mask.width,
      mask.height,
      reference.width,
      reference.height
  );
}

void check_maps(ImageView prediction, ImageView reference, MaskView mask, int channels) {
  check_same_shape(prediction, reference, mask);
  GLINT_CHECK(
      reference.channels == channels,
      kBadReference,
      "reference has {} channels, expected {}",
      reference.channels,
      channels
  );
}

bool all_finite(std::span<const float> values) {
  // Counting vectorises, searching does not, and almost always there is nothing to find.
  std::size_t num_bad = 0;
  for (const float value : values) num_bad += !std::isfinite(value);
  return num_bad == 0;
}

void check_finite(ImageView image, ExitCode code, std::string_view what) {
  const std::span<const float> values(
      image.data, image.num_pixels() * static_cast<std::size_t>(image.channels)
  );
  if (all_finite(values)) return;
  const auto bad =
      std::find_if_not(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
  const std::size_t pixel = static_cast<std::size_t>(bad - values.begin()) / image.channels;
  throw Error(
      code,
      fmt::format(
          "{}: value {} at pixel ({}, {})", what, *bad, pixel % image.width, pixel / image.width
      )
  );
}

double median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

}  // namespace glint
