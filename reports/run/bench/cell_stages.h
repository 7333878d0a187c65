// SPDX-License-Identifier: MIT
// Which stages of a cell are done, and why the others are not.
#pragma once

#include <array>

#include "reports/run/bench/plan.h"
#include "reports/run/records/scene_source.h"
#include "reports/run/records/stage_files.h"

namespace glint {

struct StageState {
  bool done = false;
  std::string why;  // not done: "mesh.voxel 0.02 -> 0.5"
  Json document;    // of what there is when done, else of what would be made
  std::string key() const { return stage_key(document); }
};

class CellStages {
 public:
  StageState& operator[](Stage stage) { return states_[static_cast<std::size_t>(stage)]; }
  const StageState& operator[](Stage stage) const {
    return states_[static_cast<std::size_t>(stage)];
  }
  bool done() const;
  // "mesh: mesh.voxel 0.02 -> 0.5; score: after mesh"; empty: all done.
  std::string why() const;

 private:
  std::array<StageState, kStages.size()> states_;
};

// Names of those that are not done, but for the making of data, which no record times.
std::vector<std::string> stages_to_do(const CellStages& stages);

// `record`: the cell's, or null. `run`: its folder; empty: as if nothing had been done (--force).
CellStages cell_stages(
    const PlanCell& cell,
    const Profile& profile,
    const SceneIdentity& scene,
    const Record* record,
    const fs::path& run
);

}  // namespace glint
