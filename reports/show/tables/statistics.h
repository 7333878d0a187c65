// SPDX-License-Identifier: MIT
// Means, spreads and intervals of results over scenes and seeds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "glint/core/rng.h"

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
// Of means, which are many: the ends of an interval are off by a sixtieth of its width. Where there
// are many pairs, fewer resamples, so that all together draw no more than kMeanDraws of them.
inline constexpr std::size_t kMeanResamples = 2000, kMeanDraws = 500'000;

// One resample of results that belong to scenes: as many scenes as there are, drawn with
// replacement, and of each drawn one as many of its seeds. Seeds of one scene are more alike than
// scenes, so drawing all pairs alike would make intervals too narrow. f(scene, seed, weight) for
// every draw; the weights sum to 1.
template <class F>
void draw_resample(std::span<const std::size_t> seeds_of_scene, Rng& rng, F&& f) {
  const auto below = [&](std::size_t n) {
    return n == 1 ? std::size_t{0} : std::size_t{rng.below(static_cast<std::uint32_t>(n))};
  };
  for (std::size_t i = 0; i < seeds_of_scene.size(); ++i) {
    const std::size_t scene = below(seeds_of_scene.size()), seeds = seeds_of_scene[scene];
    const double weight = 1 / static_cast<double>(seeds_of_scene.size() * seeds);
    for (std::size_t k = 0; k < seeds; ++k) f(scene, below(seeds), weight);
  }
}

// How many values each scene has; empty: fewer than kMinBootstrapPairs in all, which say nothing.
template <class Values>
std::vector<std::size_t> bootstrap_counts(std::span<const std::vector<Values>> scenes) {
  std::vector<std::size_t> counts;
  std::size_t all = 0;
  for (const auto& of_scene : scenes) {
    counts.push_back(of_scene.size());
    all += of_scene.size();
  }
  return all < kMinBootstrapPairs ? std::vector<std::size_t>() : counts;
}

// What lies between the 2.5 % of the values at either end. values: at least one.
Interval middle_95(std::vector<double> values);

// The percentile bootstrap interval of a mean, 95 % [Efron79]: of differences between two methods
// on the same scenes and seeds it is the paired interval. The seed is fixed, so the same values
// have the same interval. values: of each scene those of its seeds. Nothing: fewer than
// kMinBootstrapPairs values, which say nothing. Few scenes make it too narrow
// (docs/reference/reports.md).
std::optional<Interval> bootstrap_interval(
    std::span<const std::vector<double>> values, std::size_t resamples = kBootstrapResamples
);

}  // namespace glint
