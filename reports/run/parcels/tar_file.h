// SPDX-License-Identifier: MIT
// Files of a tar archive (POSIX ustar, with the long names of GNU and pax), also of one that was
// cut off on its way.
#pragma once

#include <functional>
#include <string>

#include "glint/core/files.h"

namespace glint {

struct TarMember {
  std::string name;
  std::uintmax_t bytes = 0;  // as its header says
};

// Is it one, by its first header?
bool is_tar_file(const fs::path& path);

// Calls `take` with each regular file that `wanted` chooses, and its content, one in memory at a
// time. Returns what is wrong with the archive from some place on, files before it aside: "cut off
// in room_1.parcel: 1000 of 5000 bytes"; empty: nothing. Errors (kBadReference): cannot be read.
std::string read_tar(
    const fs::path& path,
    const std::function<bool(const TarMember&)>& wanted,
    const std::function<void(const TarMember&, std::string&& content)>& take
);

}  // namespace glint
