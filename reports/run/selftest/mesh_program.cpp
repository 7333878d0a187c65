// SPDX-License-Identifier: MIT
#include "reports/run/selftest/mesh_program.h"

#include "metrics/tools/mesh.h"

namespace glint {

GLINT_PROVIDE(run_mesh_program, run_mesh_tool)

}  // namespace glint
