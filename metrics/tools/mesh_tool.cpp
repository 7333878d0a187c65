// SPDX-License-Identifier: MIT
#include <iostream>

#include "metrics/tools/mesh.h"

int main(int argc, char** argv) {
  return glint::run_mesh_tool({argv + 1, argv + argc}, std::cout, std::cerr);
}
