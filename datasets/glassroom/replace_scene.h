// SPDX-License-Identifier: MIT
// A scene that was made takes the place of an older one.
#pragma once

#include "glint/core/files.h"

namespace glint {

// `made` takes the place of `folder` (replace_folder.h): an older scene there goes, what others put
// there stays. Errors: those of replace_folder().
void replace_scene(const fs::path& made, const fs::path& folder);

// Puts in order what a killed replace_scene() left. Errors: those of recover_folder().
void recover_scene(const fs::path& folder);

}  // namespace glint
