// SPDX-License-Identifier: MIT
// Columns of words, for listings of the verbs.
#pragma once

#include <string>
#include <vector>

namespace glint {

// Rows in columns that are all flush left, two spaces apart. A last cell that does not fit in
// `width` characters goes on below itself; 0: lines are as long as they are.
std::string listing(const std::vector<std::vector<std::string>>& rows, std::size_t width = 0);

// COLUMNS, or what the terminal says; 0 where standard output is none.
std::size_t terminal_width();

}  // namespace glint
