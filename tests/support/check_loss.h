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

// The gradients of value(maps), in double, against its central differences.
template <class Value>
GradientError gradient_error_of(
    const Value& value,
    std::vector<ImageD> maps,
    const std::vector<ImageD>& gradients,
    double step = 1e-6
) {
  std::vector<double> expected, actual;
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const auto at = [&](const std::vector<double>& x) {
      std::copy(x.begin(), x.end(), maps[k].data());
      return value(maps);
    };
    const std::vector<double> here(maps[k].values().begin(), maps[k].values().end());
    const std::vector<double> slopes = central_differences(at, here, {step, 1});
    std::copy(here.begin(), here.end(), maps[k].data());
    expected.insert(expected.end(), slopes.begin(), slopes.end());
    actual.insert(actual.end(), gradients[k].values().begin(), gradients[k].values().end());
  }
  return gradient_error<double>(actual, expected);
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
  for (double& g : gradient.values()) g -= before;
  const auto weighted = [&](const std::vector<ImageD>& m) { return weight * value_of(loss, m[0]); };
  const GradientError error = gradient_error_of(weighted, {map}, {gradient}, 1e-5);
  INFO("largest difference at value " << error.worst_index);
  REQUIRE(error.norm > 0);
  CHECK(error.distance <= relative * error.norm);
}

// How far a value is moved, and how near its gradient has to come.
struct Differences {
  float step;
  double relative, absolute;
};
// Of what is computed in float: the gradient of each `stride`-th value of a map against differences
// of value(), which looks at the map.
template <class Value>
void check_slopes(
    Image& map,
    const Image& gradient,
    const Value& value,
    const Differences& by,
    std::size_t stride = 1
) {
  for (std::size_t i = 0; i < map.values().size(); i += stride) {
    float& x = map.data()[i];
    const float at = x, up = at + by.step, down = at - by.step;
    x = up;
    const double above = value();
    x = down;
    const double slope = (above - value()) / static_cast<double>(up - down);
    x = at;
    CHECK(
        static_cast<double>(gradient.data()[i]) ==
        Approx(slope).epsilon(by.relative).margin(by.absolute)
    );
  }
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
