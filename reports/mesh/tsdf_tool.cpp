// SPDX-License-Identifier: MIT
#include <iostream>

#include "reports/mesh/tsdf_program.h"

int main(int argc, char** argv) {
  return glint::run_tsdf_program(
      std::vector<std::string>(argv + 1, argv + argc), std::cout, std::cerr
  );
}
