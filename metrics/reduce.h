// SPDX-License-Identifier: MIT
// Checks and reductions that metrics share. Sums are in double, by rows: rows in parallel, their
// sums added in order, so that results do not depend on the number of threads.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "glint/core/error.h"
#include "glint/core/image.h"
#include "glint/core/parallel.h"
#include "metrics/metric.h"

namespace glint {

// Throws unless both images are non-empty and of one size and channel count (kBadPrediction), and
// the mask, if any, has their size (kBadReference).
void check_same_shape(ImageView prediction, ImageView reference, MaskView mask);
// The same for maps that must have `channels` channels.
void check_maps(ImageView prediction, ImageView reference, MaskView mask, int channels);
bool all_finite(std::span<const float> values);
// Throws `code` naming the first pixel that is not finite; `what` opens the message.
void check_finite(ImageView image, ExitCode code, std::string_view what);

struct Sum {
  double total = 0;
  std::size_t count = 0;

  Sum& operator+=(const Sum& other) {
    total += other.total;
    count += other.count;
    return *this;
  }
  std::optional<double> mean() const {
    if (count == 0) return std::nullopt;
    return total / static_cast<double>(count);
  }
};

// Adds row_sum(y) -> S over all rows, in their order. S has operator+=.
template <class S, class F>
S sum_rows(int height, F&& row_sum) {
  std::vector<S> rows(static_cast<std::size_t>(height));
  parallel_for(rows.size(), 16, [&](std::size_t y) { rows[y] = row_sum(static_cast<int>(y)); });
  S sum{};
  for (const S& row : rows) sum += row;
  return sum;
}

// Adds value(x, y) over the pixels of the mask.
template <class F>
Sum sum_pixels(ImageSize size, MaskView mask, F&& value) {
  return sum_rows<Sum>(size.height, [&](int y) {
    Sum row;
    for (int x = 0; x < size.width; ++x)
      if (counts(mask, x, y)) row += {value(x, y), 1};
    return row;
  });
}

// Mean of the two middle values when their number is even; 0 for none. Reorders `values`.
double median(std::vector<double>& values);

}  // namespace glint
