// SPDX-License-Identifier: MIT
#include <iostream>

#include "metrics/tools/tsdf.h"

int main(int argc, char** argv) {
  return glint::run_tsdf_program(
      std::vector<std::string>(argv + 1, argv + argc), std::cout, std::cerr
  );
}
