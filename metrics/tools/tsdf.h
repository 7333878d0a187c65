// SPDX-License-Identifier: MIT
// glint-tsdf: a mesh from depth maps made by anyone.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace glint {

// The whole program but for main(). `args` without the program's name. Results go to `out`, errors
// and usage to `err`. Returns the exit code.
int run_tsdf_program(const std::vector<std::string>& args, std::ostream& out, std::ostream& err);

}  // namespace glint
