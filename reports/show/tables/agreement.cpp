// SPDX-License-Identifier: MIT
#include "reports/show/tables/agreement.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <vector>

#include "glint/core/rng.h"
#include "reports/show/tables/kendall.h"

namespace glint {

namespace {

using ValueKey = std::pair<std::string, std::uint64_t>;

constexpr std::uint64_t kOrderSeed = 1938;  // [Kendall38]
constexpr std::size_t kResamples = 2000, kSampledOrders = 20'000;
constexpr int kEnumerated = 8;  // 8! = 40,320 orders
constexpr double kLevel = 0.95;

// Of the scenes and seeds that all methods have, by scene; keys are sorted by it.
std::vector<std::vector<ValueKey>> common_keys(std::span<const ComparedMethod> methods) {
  std::vector<std::vector<ValueKey>> keys;
  for (const auto& [key, value] : methods.front().values) {
    const bool common =
        std::all_of(methods.begin(), methods.end(), [&key = key](const ComparedMethod& method) {
          return method.values.contains(key);
        });
    if (!common) continue;
    if (keys.empty() || keys.back().front().first != key.first) keys.emplace_back();
    keys.back().push_back(key);
  }
  return keys;
}

// [scene][seed][method]: looking keys up in each of thousands of resamples would take seconds.
using ValuesOfScenes = std::vector<std::vector<std::vector<double>>>;
ValuesOfScenes values_of(
    std::span<const ComparedMethod> methods, const std::vector<std::vector<ValueKey>>& keys
) {
  ValuesOfScenes values(keys.size());
  for (std::size_t scene = 0; scene < keys.size(); ++scene)
    for (const ValueKey& key : keys[scene]) {
      std::vector<double>& row = values[scene].emplace_back();
      for (const ComparedMethod& method : methods) row.push_back(method.values.at(key));
    }
  return values;
}

std::optional<Interval> bootstrapped_tau(
    std::span<const ComparedMethod> methods, const std::vector<double>& published
) {
  const ValuesOfScenes values = values_of(methods, common_keys(methods));
  const std::vector<std::size_t> counts = bootstrap_counts<std::vector<double>>(values);
  if (counts.empty()) return std::nullopt;
  Rng rng(kOrderSeed);
  std::vector<double> taus;
  for (std::size_t i = 0; i < kResamples; ++i) {
    std::vector<double> means(methods.size());
    draw_resample(counts, rng, [&](std::size_t scene, std::size_t seed, double weight) {
      for (std::size_t m = 0; m < means.size(); ++m) means[m] += weight * values[scene][seed][m];
    });
    if (const double tau = kendall_tau(means, published); std::isfinite(tau)) taus.push_back(tau);
  }
  if (taus.empty()) return std::nullopt;
  return middle_95(std::move(taus));
}

std::vector<double> taus_of_random_orders(int n) {
  std::vector<double> order(static_cast<std::size_t>(n)), taus;
  std::iota(order.begin(), order.end(), 0.0);
  const std::vector<double> sorted = order;
  const auto add = [&] { taus.push_back(kendall_tau(order, sorted)); };
  if (n <= kEnumerated) {
    do add();
    while (std::next_permutation(order.begin(), order.end()));
    return taus;
  }
  Rng rng(kOrderSeed);
  for (std::size_t sample = 0; sample < kSampledOrders; ++sample) {
    for (std::size_t i = order.size() - 1; i > 0; --i)
      std::swap(order[i], order[rng.below(static_cast<std::uint32_t>(i + 1))]);
    add();
  }
  return taus;
}

Interval sampled_chance(int n) {
  std::vector<double> sizes = taus_of_random_orders(n);
  for (double& tau : sizes) tau = std::abs(tau);
  std::sort(sizes.begin(), sizes.end());
  const auto rank = static_cast<std::size_t>(std::ceil(kLevel * static_cast<double>(sizes.size())));
  return {-sizes[rank - 1], sizes[rank - 1]};
}

}  // namespace

Interval chance_interval(int n) {
  if (n < 2) return {-1, 1};
  static std::map<int, Interval> known;  // columns of a table have the same methods
  const auto [it, is_new] = known.try_emplace(n);
  if (is_new) it->second = sampled_chance(n);
  return it->second;
}

std::optional<OrderAgreement> order_agreement(std::span<const ComparedMethod> methods) {
  std::vector<double> measured, published;
  for (const ComparedMethod& method : methods) {
    measured.push_back(method.measured);
    published.push_back(method.published);
  }
  OrderAgreement result;
  result.tau = kendall_tau(measured, published);
  if (!std::isfinite(result.tau)) return std::nullopt;
  result.num_methods = static_cast<int>(methods.size());
  result.interval = bootstrapped_tau(methods, published);
  result.chance = chance_interval(result.num_methods);
  return result;
}

}  // namespace glint
