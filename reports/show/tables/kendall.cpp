// SPDX-License-Identifier: MIT
#include "reports/show/tables/kendall.h"

#include <cmath>
#include <limits>

namespace glint {

namespace {
int sign(double difference) { return (difference > 0) - (difference < 0); }
}  // namespace

double kendall_tau(std::span<const double> a, std::span<const double> b) {
  double concordance = 0, untied_a = 0, untied_b = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const int order_a = sign(a[i] - a[j]), order_b = sign(b[i] - b[j]);
      concordance += order_a * order_b;
      untied_a += order_a * order_a;
      untied_b += order_b * order_b;
    }
  if (untied_a == 0 || untied_b == 0) return std::numeric_limits<double>::quiet_NaN();
  return concordance / std::sqrt(untied_a * untied_b);
}

}  // namespace glint
