// SPDX-License-Identifier: MIT
#pragma once

namespace CLI {
class App;
}

namespace glint {

// Numbers of a parsed command line and its verbs. Errors (kUsage): one is not finite; CLI11 takes
// "nan" and "inf", and comparisons with them let anything pass.
void check_numbers(const CLI::App& app);

}  // namespace glint
