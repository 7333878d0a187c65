// SPDX-License-Identifier: MIT
#pragma once

namespace glint {

// Parses, runs and reports errors on standard error: the whole of glint-bench's main().
int run_command_line(int argc, const char* const* argv);

}  // namespace glint
