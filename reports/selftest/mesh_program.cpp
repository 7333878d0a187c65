// SPDX-License-Identifier: MIT
#include "reports/selftest/mesh_program.h"

#include "metrics/tools/mesh.h"

namespace glint {

int run_mesh_program(
    const std::vector<std::string>& arguments, std::ostream& out, std::ostream& err
) {
  return run_mesh_tool(arguments, out, err);
}

}  // namespace glint
