// SPDX-License-Identifier: MIT
// Files below a folder as programs see them that follow links: photos often lie behind one.
#pragma once

#include <functional>
#include <vector>

#include "glint/core/files.h"

namespace glint {

// Sorted by their names below `folder`, through links to folders. What `leaves_out` says yes to is
// not looked up. Errors: those of list_files_below() (glint/core/presence.h); (kBadReference) a
// link that leads back to a folder around it.
std::vector<fs::path> list_linked_files(
    const fs::path& folder,
    const std::function<bool(const fs::path& path)>& leaves_out =
        [](const fs::path&) { return false; }
);

}  // namespace glint
