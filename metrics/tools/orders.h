// SPDX-License-Identifier: MIT
// The program glint-orders: orders of annotated points across layers, LayeredDepth's metric
// (metrics/orders.h).
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace glint {

// `args` without the program's name. Results go to `out`, errors and usage to `err`. Returns the
// exit code.
int run_orders_program(const std::vector<std::string>& args, std::ostream& out, std::ostream& err);

}  // namespace glint
