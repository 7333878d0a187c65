// SPDX-License-Identifier: MIT
// The text of a C++ or CUDA source as far as it decides what the program computes: comments and
// blanks do not count, so that writing about code does not call for new results.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace glint {

// Without comments and without the blanks that separate nothing. Literals (raw strings too) stay as
// they are; directives keep lines of their own. Not for a compiler: only to compare and hash.
std::string code_of(std::string_view text);

// The files named by #include "..." in a text of code_of().
std::vector<std::string> quoted_includes(std::string_view code);

}  // namespace glint
