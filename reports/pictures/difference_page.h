// SPDX-License-Identifier: MIT
// A picture of two renderings of a scene and how they differ.
#pragma once

#include <string>
#include <vector>

#include "glint/core/files.h"
#include "glint/core/image.h"
#include "glint/core/service.h"

namespace glint {

// A row: all three [h][w][3], as displayed.
struct DifferenceRow {
  std::string view;
  Image first, second, difference;
};

struct DifferencePage {
  std::string first, second;  // where they lie
  float range = 0;            // of relative differences that have colours
  std::vector<DifferenceRow> rows;
};

// Writes a PNG. Errors: write_png()'s.
inline constinit Service<void(const fs::path& picture, const DifferencePage& page)>
    write_difference_page{"drawing differences", "use the full build"};

}  // namespace glint
