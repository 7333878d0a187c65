// SPDX-License-Identifier: MIT
// Gradients by finite differences, to check analytic ones against.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace glint::test {

// h = relative max(|x_i|, floor). The default balances the error of the extrapolated difference,
// which falls with h^4, with rounding in double.
struct DifferenceStep {
  double relative = 1e-4, floor = 1;
};

// df/dx_i by central differences at h and h/2, extrapolated [Richardson 1911].
template <class F>
double central_difference(
    F&& f, std::vector<double>& x, std::size_t i, const DifferenceStep& step = {}
) {
  const double at = x[i];
  const auto slope = [&](double h) {
    x[i] = at + h;
    const double above = f(x);
    x[i] = at - h;
    const double below = f(x);
    x[i] = at;
    return (above - below) / (2 * h);
  };
  const double h = step.relative * std::max(step.floor, std::abs(at));
  return (4 * slope(h / 2) - slope(h)) / 3;
}

// The gradient of the scalar function f(const std::vector<double>&) at x.
template <class F>
std::vector<double> central_differences(
    F&& f, std::vector<double> x, const DifferenceStep& step = {}
) {
  std::vector<double> gradient(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) gradient[i] = central_difference(f, x, i, step);
  return gradient;
}

struct GradientError {
  double distance = 0;          // |actual - expected|, Euclidean norms
  double norm = 0;              // |expected|
  std::size_t worst_index = 0;  // of the largest difference
};

// `actual` and `expected` of one length. A NaN makes the distance NaN, which no bound accepts.
template <class T>
GradientError gradient_error(std::span<const T> actual, std::span<const double> expected) {
  GradientError error;
  double distance2 = 0, norm2 = 0, worst = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const double difference = std::abs(static_cast<double>(actual[i]) - expected[i]);
    distance2 += difference * difference;
    norm2 += expected[i] * expected[i];
    if (difference <= worst) continue;
    worst = difference;
    error.worst_index = i;
  }
  error.distance = std::sqrt(distance2);
  error.norm = std::sqrt(norm2);
  return error;
}

}  // namespace glint::test
