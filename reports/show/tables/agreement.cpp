// SPDX-License-Identifier: MIT
#include "reports/show/tables/agreement.h"

#include <algorithm>
#include <array>
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

using Columns = std::span<const std::vector<ComparedMethod>>;

std::vector<double> published_of(std::span<const ComparedMethod> methods) {
  std::vector<double> published;
  for (const ComparedMethod& method : methods) published.push_back(method.published);
  return published;
}

// What one column is resampled from.
struct ResampledColumn {
  ValuesOfScenes values;
  std::vector<double> published;
};

// Of the keys that all columns have for all methods.
std::vector<std::vector<ValueKey>> keys_of_columns(Columns columns) {
  std::vector<ComparedMethod> all;
  for (const auto& column : columns) all.insert(all.end(), column.begin(), column.end());
  return common_keys(all);
}

std::vector<ResampledColumn> resampled_columns(Columns columns) {
  const auto keys = keys_of_columns(columns);
  std::vector<ResampledColumn> resampled;
  for (const auto& column : columns)
    resampled.push_back({values_of(column, keys), published_of(column)});
  return resampled;
}

double resampled_tau(
    const ResampledColumn& column,
    const std::vector<std::array<std::size_t, 2>>& drawn,
    const std::vector<double>& weights
) {
  std::vector<double> means(column.published.size());
  for (std::size_t i = 0; i < drawn.size(); ++i)
    for (std::size_t m = 0; m < means.size(); ++m)
      means[m] += weights[i] * column.values[drawn[i][0]][drawn[i][1]][m];
  return kendall_tau(means, column.published);
}

std::optional<Interval> bootstrapped_tau(Columns columns) {
  const auto resampled = resampled_columns(columns);
  const std::vector<std::size_t> counts =
      bootstrap_counts<std::vector<double>>(resampled.front().values);
  if (counts.empty()) return std::nullopt;
  Rng rng(kOrderSeed);
  std::vector<double> taus;
  for (std::size_t i = 0; i < kResamples; ++i) {
    std::vector<std::array<std::size_t, 2>> drawn;
    std::vector<double> weights;
    draw_resample(counts, rng, [&](std::size_t scene, std::size_t seed, double weight) {
      drawn.push_back({scene, seed});
      weights.push_back(weight);
    });
    double sum = 0;
    for (const ResampledColumn& column : resampled) sum += resampled_tau(column, drawn, weights);
    if (std::isfinite(sum)) taus.push_back(sum / static_cast<double>(resampled.size()));
  }
  if (taus.empty()) return std::nullopt;
  return middle_95(std::move(taus));
}

// f(order) for every order of n things; of many, for a fixed sample of orders.
template <class F>
void for_each_order(int n, F&& f) {
  std::vector<std::size_t> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (n <= kEnumerated) {
    do f(order);
    while (std::next_permutation(order.begin(), order.end()));
    return;
  }
  Rng rng(kOrderSeed);
  for (std::size_t sample = 0; sample < kSampledOrders; ++sample) {
    for (std::size_t i = order.size() - 1; i > 0; --i)
      std::swap(order[i], order[rng.below(static_cast<std::uint32_t>(i + 1))]);
    f(order);
  }
}

// The narrowest around 0 that holds so many of them.
Interval middle_around_zero(std::vector<double> taus) {
  for (double& tau : taus) tau = std::abs(tau);
  std::sort(taus.begin(), taus.end());
  const auto rank = static_cast<std::size_t>(std::ceil(kLevel * static_cast<double>(taus.size())));
  return {-taus[rank - 1], taus[rank - 1]};
}

Interval sampled_chance(int n) {
  std::vector<double> sorted(static_cast<std::size_t>(n)), taus;
  std::iota(sorted.begin(), sorted.end(), 0.0);
  for_each_order(n, [&](const std::vector<std::size_t>& order) {
    taus.push_back(kendall_tau(std::vector<double>(order.begin(), order.end()), sorted));
  });
  return middle_around_zero(std::move(taus));
}

// The column's tau if its methods had each other's values.
double tau_in_order(
    const std::vector<ComparedMethod>& column, const std::vector<std::size_t>& order
) {
  std::vector<double> measured;
  for (const std::size_t method : order) measured.push_back(column[method].measured);
  return kendall_tau(measured, published_of(column));
}

double mean_tau(Columns columns, const std::vector<std::size_t>& order) {
  double sum = 0;
  for (const auto& column : columns) sum += tau_in_order(column, order);
  return sum / static_cast<double>(columns.size());
}

Interval chance_of_columns(Columns columns) {
  std::vector<double> taus;
  for_each_order(
      static_cast<int>(columns.front().size()),
      [&](const std::vector<std::size_t>& order) { taus.push_back(mean_tau(columns, order)); }
  );
  return middle_around_zero(std::move(taus));
}

OrderAgreement agreement_of(Columns columns, double tau, Interval chance) {
  OrderAgreement result;
  result.tau = tau;
  result.num_methods = static_cast<int>(columns.front().size());
  result.interval = bootstrapped_tau(columns);
  result.chance = chance;
  return result;
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
  std::vector<double> measured;
  for (const ComparedMethod& method : methods) measured.push_back(method.measured);
  const double tau = kendall_tau(measured, published_of(methods));
  if (!std::isfinite(tau)) return std::nullopt;
  const std::vector<ComparedMethod> column(methods.begin(), methods.end());
  return agreement_of({&column, 1}, tau, chance_interval(static_cast<int>(methods.size())));
}

std::optional<OrderAgreement> mean_order_agreement(
    std::span<const std::vector<ComparedMethod>> columns
) {
  if (columns.empty() || columns.front().size() < 2) return std::nullopt;
  std::vector<std::size_t> as_it_is(columns.front().size());
  std::iota(as_it_is.begin(), as_it_is.end(), std::size_t{0});
  const double tau = mean_tau(columns, as_it_is);
  if (!std::isfinite(tau)) return std::nullopt;
  return agreement_of(columns, tau, chance_of_columns(columns));
}

}  // namespace glint
