// SPDX-License-Identifier: MIT
#include "reports/tables/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "glint/core/rng.h"

namespace glint {

namespace {

constexpr std::uint64_t kSeed = 1979;
constexpr std::size_t kTail = kBootstrapResamples / 40;  // 2.5 % to either side

double resampled_mean(std::span<const double> values, Rng& rng) {
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    sum += values[rng.below(static_cast<std::uint32_t>(values.size()))];
  return sum / static_cast<double>(values.size());
}

}  // namespace

double mean_of(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double spread_of(std::span<const double> values) {
  if (values.size() < 2) return 0;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  if (values.size() == 2) return *high - *low;
  const double mean = mean_of(values);
  double sum = 0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

std::optional<Interval> bootstrap_interval(std::span<const double> values) {
  if (values.size() < kMinBootstrapPairs) return std::nullopt;
  Rng rng(kSeed);
  std::vector<double> means(kBootstrapResamples);
  for (double& mean : means) mean = resampled_mean(values, rng);
  std::sort(means.begin(), means.end());
  return Interval{means[kTail], means[kBootstrapResamples - 1 - kTail]};
}

}  // namespace glint
