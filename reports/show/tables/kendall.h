// SPDX-License-Identifier: MIT
// Agreement of two orders: do we rank methods as the paper does?
#pragma once

#include <span>

namespace glint {

// Kendall's tau-b of paired values [Kendall45]: 1 same order, -1 reversed; ties are corrected for.
// NaN when one side is constant or there are fewer than two pairs. Sizes must be equal.
double kendall_tau(std::span<const double> a, std::span<const double> b);

}  // namespace glint
