// SPDX-License-Identifier: MIT
// The program glint-mesh: two surfaces in, Chamfer distance, F1 and normal consistency out. A
// sibling of the image programs (tool.h) with the same look.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace glint {

// The whole program but for main(). `args` without the program's name. Results go to `out`, errors
// and usage to `err`. Returns the exit code.
int run_mesh_tool(const std::vector<std::string>& args, std::ostream& out, std::ostream& err);

}  // namespace glint
