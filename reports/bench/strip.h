// SPDX-License-Identifier: MIT
// strip.png: rows of ground truth, render, error, depth and normals side by side, to look at.
#pragma once

#include "glint/core/files.h"
#include "glint/scene/scene.h"

namespace glint {

inline constexpr int kStripViews = 4;      // rows, evenly spread over the test views
inline constexpr float kErrorGain = 4.0f;  // |render - truth| is shown this much brighter

// From the files of `run`/renders. Panels in order: truth, render, error, depth, true depth,
// normal, true normal; those that do not exist are grey.
void write_strip(const fs::path& run, const std::vector<View>& views);

}  // namespace glint
