// SPDX-License-Identifier: MIT
// A scene that was made takes the place of an older one.
#pragma once

#include "glint/core/files.h"

namespace glint {

// Moves `made` to `folder`. An older scene there goes file by file; what it holds beyond its own
// files stays. `scene.json` comes last: stopped before it, the folder is a damaged scene, which is
// made again. Errors: kEnvironment, a file cannot be moved.
void replace_scene(const fs::path& made, const fs::path& folder);

}  // namespace glint
