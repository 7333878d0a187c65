// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace glint {

inline double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Of as many values, at least one; of the population, not of a sample.
inline double covariance(const std::vector<double>& a, const std::vector<double>& b) {
  const double mean_a = mean_of(a), mean_b = mean_of(b);
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - mean_a) * (b[i] - mean_b);
  return sum / static_cast<double>(a.size());
}

// Pearson's, of as many values, at least one; 0 where either does not vary.
inline double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const double both = covariance(a, a) * covariance(b, b);
  return both > 0 ? covariance(a, b) / std::sqrt(both) : 0;
}

}  // namespace glint
