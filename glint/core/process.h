// SPDX-License-Identifier: MIT
// What every program says and does alike when it starts and when it cannot go on.
#pragma once

#include <string_view>

namespace glint {

inline constexpr std::string_view kNoOutput =
    "standard output cannot be written (a full disk, or whoever read it has gone)";
inline constexpr std::string_view kOutOfMemory =
    "out of memory; use smaller images or fewer threads";

// A limit on the size of files (ulimit -f) ends in an error that names the file, as a full disk
// does, not in a signal without a word.
void ignore_file_size_signal();

}  // namespace glint
