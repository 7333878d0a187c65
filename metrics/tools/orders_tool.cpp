// SPDX-License-Identifier: MIT
#include <iostream>

#include "metrics/tools/orders.h"

int main(int argc, char** argv) {
  return glint::run_orders_program({argv + 1, argv + argc}, std::cout, std::cerr);
}
