// SPDX-License-Identifier: MIT
// Files CCCC.FFFF.<pass>.png of one clip (prior_files.h).
#pragma once

#include <map>
#include <optional>

#include "datasets/prior_files.h"

namespace glint {

// All that other programs left for the views of a scene.
struct FoundPriors {
  std::string program;             // "DiffusionRenderer, SVD"
  std::vector<MapFiles> files;     // one a view; a kind that no view has is missing
  std::vector<fs::path> metallic;  // one a view
  PriorReading documented;         // how the program stores them
  std::vector<std::string> notes;

  explicit FoundPriors(std::size_t num_views) : files(num_views), metallic(num_views) {}
};

// Nothing: no such files. `overlap`: as in PriorOptions. Errors (kBadReference): as attach_priors.
std::optional<FoundPriors> find_chunked_priors(
    const fs::path& folder, const SceneIndex& index, int overlap
);

}  // namespace glint
