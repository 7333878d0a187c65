// SPDX-License-Identifier: MIT
// In place of glint-mesh, which needs Embree.
#include <ostream>

#include "glint/core/error.h"
#include "reports/selftest/mesh_program.h"

namespace glint {

int run_mesh_program(const std::vector<std::string>&, std::ostream&, std::ostream& err) {
  err << "glint-mesh needs the full build; this is a lean one\n";
  return static_cast<int>(ExitCode::kEnvironment);
}

}  // namespace glint
