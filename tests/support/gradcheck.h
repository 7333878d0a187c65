// SPDX-License-Identifier: MIT
// Gradients by finite differences, to check analytic ones against.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace glint::test {

// df/dx_i by central differences at h and h/2, extrapolated [Richardson 1911]: the error falls with
// h^4. h = relative_step max(1, |x_i|); the default balances it with rounding in double.
template <class F>
double central_difference(
    F&& f, std::vector<double>& x, std::size_t i, double relative_step = 1e-4
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
  const double h = relative_step * std::max(1.0, std::abs(at));
  return (4 * slope(h / 2) - slope(h)) / 3;
}

// The gradient of the scalar function f(const std::vector<double>&) at x.
template <class F>
std::vector<double> central_differences(F&& f, std::vector<double> x, double relative_step = 1e-4) {
  std::vector<double> gradient(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    gradient[i] = central_difference(f, x, i, relative_step);
  return gradient;
}

struct GradientError {
  double relative = 0;  // |actual - expected| / |expected|, Euclidean norms
  double worst = 0;     // largest |actual_i - expected_i| / max_i |expected_i|
  std::size_t worst_index = 0;
  double norm = 0;  // |expected|
};

template <class T>
GradientError gradient_error(std::span<const T> actual, std::span<const double> expected) {
  GradientError error;
  double difference2 = 0, norm2 = 0, largest = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const double difference = std::abs(static_cast<double>(actual[i]) - expected[i]);
    difference2 += difference * difference;
    norm2 += expected[i] * expected[i];
    largest = std::max(largest, std::abs(expected[i]));
    if (!(difference <= error.worst)) error.worst = difference, error.worst_index = i;
  }
  error.norm = std::sqrt(norm2);
  error.relative = std::sqrt(difference2) / std::max(error.norm, 1e-300);
  error.worst /= std::max(largest, 1e-300);
  return error;
}

}  // namespace glint::test
