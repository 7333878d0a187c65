// SPDX-License-Identifier: MIT
// Means, spreads and intervals of results over scenes and seeds.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace glint {

double mean_of(std::span<const double> values);  // of at least one value

// Sample standard deviation of three values and more. Two values have no meaningful deviation:
// their range is given instead. 0 for fewer.
double spread_of(std::span<const double> values);

struct Interval {
  double low = 0, high = 0;
  bool contains(double value) const { return low <= value && value <= high; }
};

inline constexpr std::size_t kMinBootstrapPairs = 3, kBootstrapResamples = 10'000;

// The percentile bootstrap interval of a mean, 95 % [Efron79]: of differences between two methods
// on the same scenes and seeds it is the paired interval. The seed is fixed, so the same values
// have the same interval. Nothing: fewer than kMinBootstrapPairs values, which say nothing.
std::optional<Interval> bootstrap_interval(std::span<const double> values);

}  // namespace glint
