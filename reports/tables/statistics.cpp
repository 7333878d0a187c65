// SPDX-License-Identifier: MIT
#include "reports/tables/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace glint {

namespace {

constexpr std::uint64_t kSeed = 1979;
constexpr std::size_t kTail = kBootstrapResamples / 40;  // 2.5 % to either side

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

std::optional<Interval> bootstrap_interval(std::span<const std::vector<double>> values) {
  std::vector<std::size_t> counts;
  for (const std::vector<double>& of_scene : values) counts.push_back(of_scene.size());
  if (std::accumulate(counts.begin(), counts.end(), std::size_t{0}) < kMinBootstrapPairs)
    return std::nullopt;
  Rng rng(kSeed);
  std::vector<double> means(kBootstrapResamples);
  for (double& mean : means)
    draw_resample(counts, rng, [&](std::size_t scene, std::size_t seed, double weight) {
      mean += weight * values[scene][seed];
    });
  std::sort(means.begin(), means.end());
  return Interval{means[kTail], means[kBootstrapResamples - 1 - kTail]};
}

}  // namespace glint
