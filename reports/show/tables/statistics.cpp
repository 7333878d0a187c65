// SPDX-License-Identifier: MIT
#include "reports/show/tables/statistics.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace glint {

namespace {

constexpr std::uint64_t kSeed = 1979;

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

Interval middle_95(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t tail = values.size() / 40;
  return {values[tail], values[values.size() - 1 - tail]};
}

std::optional<Interval> bootstrap_interval(
    std::span<const std::vector<double>> values, std::size_t resamples
) {
  const std::vector<std::size_t> counts = bootstrap_counts<double>(values);
  if (counts.empty()) return std::nullopt;
  Rng rng(kSeed);
  std::vector<double> means(resamples);
  for (double& mean : means)
    draw_resample(counts, rng, [&](std::size_t scene, std::size_t seed, double weight) {
      mean += weight * values[scene][seed];
    });
  return middle_95(std::move(means));
}

}  // namespace glint
