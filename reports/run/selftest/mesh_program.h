// SPDX-License-Identifier: MIT
// glint-mesh where the build has it.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "glint/core/service.h"

namespace glint {

// As run_mesh_tool().
inline constinit Service<
    int(const std::vector<std::string>& arguments, std::ostream& out, std::ostream& err)>
    run_mesh_program{"glint-mesh", "use the full build"};

}  // namespace glint
