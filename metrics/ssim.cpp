// SPDX-License-Identifier: MIT
#include "metrics/ssim.h"

#include <algorithm>
#include <vector>

#include "metrics/reduce.h"

namespace glint {
namespace {

constexpr std::size_t kMoments = 5;  // E[x], E[y], E[x^2], E[y^2], E[x y]

// The moments of one image row; channels interleaved, zeros before and after it for the window.
struct MomentRow {
  MomentRow(std::size_t num_values, std::size_t padding)
      : stride(num_values + 2 * padding), first(padding), values(kMoments * stride, 0.0) {}
  double* moment(std::size_t m) { return values.data() + m * stride + first; }

  std::size_t stride, first;
  std::vector<double> values;
};

using TapRows = std::array<const float*, kSsimTaps>;
using Weights = std::array<double, kSsimTaps>;

// Sums of a block of values, small enough for the nearest cache while the taps are added.
constexpr std::size_t kBlock = 128;
using BlockSums = std::array<std::array<double, kBlock>, kMoments>;

// Adds one tap of the window: n values of a row of each image.
void add_products(const float* x, const float* y, double w, std::size_t n, BlockSums& sums) {
  for (std::size_t i = 0; i < n; ++i) {
    const double a = static_cast<double>(x[i]), b = static_cast<double>(y[i]);
    const double wa = w * a, wb = w * b;
    sums[0][i] += wa;
    sums[1][i] += wb;
    sums[2][i] = fma_of(wa, a, sums[2][i]);
    sums[3][i] = fma_of(wb, b, sums[3][i]);
    sums[4][i] = fma_of(wa, b, sums[4][i]);
  }
}

// Weighted sums over the rows under the window's column, for n values of a row.
void vertical_pass(
    const TapRows& x, const TapRows& y, const Weights& w, std::size_t n, MomentRow& row
) {
  for (std::size_t begin = 0; begin < n; begin += kBlock) {
    const std::size_t count = std::min(kBlock, n - begin);
    BlockSums sums{};
    for (int k = 0; k < kSsimTaps; ++k) add_products(x[k] + begin, y[k] + begin, w[k], count, sums);
    for (std::size_t m = 0; m < kMoments; ++m)
      std::copy_n(sums[m].data(), count, row.moment(m) + begin);
  }
}

// Finishes the window along the row and evaluates the formula. ssim: n values, channels
// interleaved, so that neighbouring pixels are `channels` values apart.
void horizontal_pass(
    MomentRow& row, const Weights& w, std::ptrdiff_t channels, std::size_t n, double* ssim
) {
  for (std::size_t begin = 0; begin < n; begin += kBlock) {
    const std::size_t count = std::min(kBlock, n - begin);
    BlockSums sums{};
    for (std::size_t m = 0; m < kMoments; ++m)
      for (int k = 0; k < kSsimTaps; ++k) {
        const double* from = row.moment(m) + begin + (k - kSsimRadius) * channels;
        for (std::size_t i = 0; i < count; ++i) sums[m][i] = fma_of(w[k], from[i], sums[m][i]);
      }
    for (std::size_t i = 0; i < count; ++i)
      ssim[begin + i] =
          ssim_from_moments(sums[0][i], sums[1][i], sums[2][i], sums[3][i], sums[4][i]);
  }
}

// The rows under the window centred on row y; `zeros` above and below the image.
TapRows rows_around(ImageView image, int y, const float* zeros) {
  TapRows rows{};
  for (int k = 0; k < kSsimTaps; ++k) {
    const int row = y + k - kSsimRadius;
    rows[k] = row >= 0 && row < image.height ? image.pixel(0, row) : zeros;
  }
  return rows;
}

void average_channels(const std::vector<double>& ssim, int channels, int width, double* map_row) {
  const double* value = ssim.data();
  for (int x = 0; x < width; ++x) {
    double sum = 0;
    for (int c = 0; c < channels; ++c) sum += *value++;
    map_row[x] = sum / channels;
  }
}

void ssim_rows(ImageView prediction, ImageView reference, int begin, int end, SsimMap& map) {
  const auto weights = ssim_window<double>();
  const int channels = reference.channels;
  const std::size_t n = static_cast<std::size_t>(reference.width) * channels;
  const std::vector<float> zeros(n, 0.0f);
  std::vector<double> ssim(n);
  MomentRow row(n, static_cast<std::size_t>(kSsimRadius) * channels);
  for (int y = begin; y < end; ++y) {
    const TapRows x_rows = rows_around(prediction, y, zeros.data());
    const TapRows y_rows = rows_around(reference, y, zeros.data());
    vertical_pass(x_rows, y_rows, weights, n, row);
    horizontal_pass(row, weights, channels, n, ssim.data());
    average_channels(ssim, channels, reference.width, map.pixel(0, y));
  }
}

Image clamped(ImageView image) {
  Image result(image.width, image.height, image.channels);
  parallel_for_blocks(result.values().size(), 1 << 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      result.data()[i] = std::clamp(image.data[i], 0.0f, 1.0f);
  });
  return result;
}

}  // namespace

SsimMap ssim_map(ImageView prediction, ImageView reference) {
  check_same_shape(prediction, reference, {});
  check_finite(prediction, ExitCode::kBadPrediction, "prediction");
  check_finite(reference, ExitCode::kBadReference, "reference");
  const Image x = clamped(prediction);
  SsimMap map(reference.width, reference.height, 1);
  parallel_for_blocks(
      static_cast<std::size_t>(reference.height),
      16,
      [&](std::size_t begin, std::size_t end) {
        ssim_rows(x, reference, static_cast<int>(begin), static_cast<int>(end), map);
      }
  );
  return map;
}

std::optional<double> ssim_mean(const SsimMap& map, SsimBorder border, MaskView mask) {
  const int margin = border == SsimBorder::kValid ? kSsimRadius : 0;
  const Sum sum = sum_rows<Sum>(map.height(), [&](int y) {
    Sum row;
    if (y < margin || y >= map.height() - margin) return row;
    for (int x = margin; x < map.width() - margin; ++x)
      if (counts(mask, x, y)) row += {map.at(x, y), 1};
    return row;
  });
  return sum.mean();
}

double ssim(ImageView prediction, ImageView reference, SsimBorder border, MaskView mask) {
  check_same_shape(prediction, reference, mask);
  const std::optional<double> mean = ssim_mean(ssim_map(prediction, reference), border, mask);
  GLINT_CHECK(
      mean.has_value(),
      kBadReference,
      "no pixel to average SSIM over: image of {} x {} pixels, window of {}, or an empty mask",
      reference.width,
      reference.height,
      kSsimTaps
  );
  return *mean;
}

double ssim_3dgs(ImageView prediction, ImageView reference, MaskView mask) {
  return ssim(prediction, reference, SsimBorder::kZeroPadded, mask);
}

double ssim_wang(ImageView prediction, ImageView reference, MaskView mask) {
  return ssim(prediction, reference, SsimBorder::kValid, mask);
}

}  // namespace glint
