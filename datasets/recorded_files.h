// SPDX-License-Identifier: MIT
// The files of a made scene against what its scene.json recorded of them when it was written.
#pragma once

#include <string>
#include <vector>

#include "datasets/findings.h"
#include "glint/core/files.h"

namespace glint {

struct RecordedFiles {
  std::size_t num_recorded = 0;
  std::vector<std::string> missing, changed;  // below the folder, in the order of names
};

// By the "files" of scene.json (name -> hash, file_hashes()); a folder without them has recorded
// none. Reads every file.
RecordedFiles compare_recorded(const fs::path& folder);

// At most one finding for what is missing and one for what has changed (check: recorded-files);
// files that `findings` names already are left out.
void check_recorded(const fs::path& folder, std::vector<Finding>& findings);

}  // namespace glint
