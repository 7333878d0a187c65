// SPDX-License-Identifier: MIT
// Do we rank methods as the paper does? Kendall's tau of one measured column with its published
// counterpart, and two intervals without which a tau of six methods says little.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "reports/show/tables/statistics.h"

namespace glint {

struct OrderAgreement {
  std::string column;  // id of the measured column
  double tau = 0;      // Kendall's tau-b
  int num_methods = 0;
  // 95 %: measured means bootstrapped over scenes and seeds that all the methods have, published
  // numbers as they are. Nothing: fewer than kMinBootstrapPairs of them.
  std::optional<Interval> interval;
  Interval chance;  // holds at least 95 % of the taus of random orders of so many methods
};

struct ComparedMethod {
  double measured = 0, published = 0;
  std::map<std::pair<std::string, std::uint64_t>, double> values;  // of each scene and seed
};

// `column` is left empty. Nothing: tau is not defined (fewer than two methods, or one side is
// constant).
std::optional<OrderAgreement> order_agreement(std::span<const ComparedMethod> methods);

// The same of several columns together: the mean of their taus, whose interval comes from resamples
// of scenes and seeds that all columns share, and whose chance from orders that all columns take
// together, since columns of a table are alike. Every column has the same methods in one order.
// Nothing: a column without tau.
std::optional<OrderAgreement> mean_order_agreement(
    std::span<const std::vector<ComparedMethod>> columns
);

// The narrowest interval around 0 with at least 95 % of the taus of all orders of n different
// values; of more than 8, of a fixed sample of orders. {-1, 1} for fewer than two.
Interval chance_interval(int n);

}  // namespace glint
