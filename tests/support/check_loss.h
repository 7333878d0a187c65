// SPDX-License-Identifier: MIT
// Checks for losses on a map. A loss is a generic callable (map, weight, gradient) -> value that
// takes BasicImage<T> and T for both float and double.
#pragma once

#include <catch2/catch.hpp>

#include "glint/core/error.h"
#include "glint/core/image.h"
#include "glint/core/vec.h"
#include "tests/support/gradcheck.h"
#include "tests/support/random_values.h"
#include "tests/support/same_bytes.h"
#include "tests/support/threads.h"

namespace glint::test {

using ImageD = BasicImage<double>;

inline ImageD in_double(const Image& image) {
  ImageD out(image.width(), image.height(), image.channels());
  std::copy(image.values().begin(), image.values().end(), out.data());
  return out;
}
template <class T>
BasicImage<T> map_of(int width, int height, int channels, const std::vector<T>& values) {
  BasicImage<T> map(width, height, channels);
  REQUIRE(map.values().size() == values.size());
  std::copy(values.begin(), values.end(), map.data());
  return map;
}

template <class T, class Loss>
double value_of(const Loss& loss, const BasicImage<T>& map) {
  BasicImage<T> gradient(map.width(), map.height(), map.channels());
  return loss(map, T(1), gradient);
}
template <class T, class Loss>
BasicImage<T> gradient_of(const Loss& loss, const BasicImage<T>& map, T weight = 1) {
  BasicImage<T> gradient(map.width(), map.height(), map.channels());
  loss(map, weight, gradient);
  return gradient;
}

// In double, against central differences of the value: the gradient is right, is scaled by the
// weight and is added to what is there. The map must be further than the step from the loss's
// kinks.
template <class Loss>
void check_loss_gradient(const ImageD& map, const Loss& loss, double relative = 1e-7) {
  const double weight = 0.25, before = 3;
  ImageD gradient(map.width(), map.height(), map.channels(), before);
  const double value = loss(map, weight, gradient);
  CHECK(value == value_of(loss, map));  // the value returned does not depend on the weight
  const auto at = [&](const std::vector<double>& x) {
    ImageD moved = map;
    std::copy(x.begin(), x.end(), moved.data());
    return value_of(loss, moved);
  };
  std::vector<double> x(map.values().begin(), map.values().end());
  std::vector<double> expected = central_differences(at, x, {1e-5, 1});
  for (double& g : expected) g = before + weight * g;
  const GradientError error = gradient_error<double>(gradient.values(), expected);
  double norm = 0;  // without what was there before
  for (const double g : expected) norm += (g - before) * (g - before);
  INFO("largest difference at value " << error.worst_index);
  REQUIRE(norm > 0);
  CHECK(error.distance <= relative * std::sqrt(norm));
}

// Same bytes with any number of threads.
template <class Loss>
void check_thread_independence(const Image& map, const Loss& loss) {
  const auto evaluated = [&] { return std::pair(value_of(loss, map), gradient_of(loss, map)); };
  const auto [value, gradient] = with_threads(1, evaluated);
  for (const int threads : {2, 5}) {
    const auto again = with_threads(threads, evaluated);
    CHECK(again.first == value);
    CHECK(same_bytes(again.second, gradient));
  }
}

template <class Loss>
void check_no_loss(const Image& map, const Loss& loss) {
  CHECK(value_of(loss, map) == 0);
  const Image gradient = gradient_of(loss, map);
  for (const float g : gradient.values()) CHECK(g == 0.0f);
}

}  // namespace glint::test
