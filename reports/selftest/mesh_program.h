// SPDX-License-Identifier: MIT
// glint-mesh where the build has it.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace glint {

// As run_mesh_tool(); a lean build's ends with exit code 6.
int run_mesh_program(
    const std::vector<std::string>& arguments, std::ostream& out, std::ostream& err
);

}  // namespace glint
