// SPDX-License-Identifier: MIT
// What a machine without Open3D left open is done here: meshes of runs that came in parcels, fused
// from the depth of what is left of their models, and their scores.
#pragma once

#include "reports/run/records/merge_runs.h"
#include "reports/run/records/profile.h"
#include "reports/run/records/scene_source.h"

namespace glint {

struct CompletionOptions {
  Profile profile;
  fs::path folder;  // the profile's: records.jsonl, runs/
  SceneLoader load;
  bool write = true;  // false: only says what would be done
};

// Of a cell whose meshes were wanting.
struct CompletedCell {
  CellKey cell;
  bool made = false;    // or would be
  std::string why_not;  // "no Open3D", "the scene's hash is ..."
};

// All cells of the folder that came in parcels and have no meshes yet, scene by scene. A cell that
// cannot be completed is left as it is, with the reason; the same call later tries it again.
// Errors: kEnvironment: files cannot be written; Interrupted.
std::vector<CompletedCell> complete_meshes(const CompletionOptions& options);

}  // namespace glint
