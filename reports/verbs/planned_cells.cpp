// SPDX-License-Identifier: MIT
#include "reports/verbs/planned_cells.h"

#include "reports/records/run_folder.h"

namespace glint {

std::string PlannedCell::state() const {
  if (stages.done()) return "done";
  if (record == nullptr) return "pending";
  return record->ok() ? "stale" : "failed";
}

std::vector<PlannedCell> planned_cells(
    const CommonOptions& common, const Profile& profile, const std::vector<Record>& records
) {
  const SceneIdentifier identify = common.scene_identifier();
  const fs::path folder = common.own_folder(profile);
  std::map<std::string, SceneIdentity> scenes;  // by name
  std::vector<PlannedCell> cells;
  for (const PlanCell& cell : make_plan(profile, common.filter(), common.set)) {
    if (!scenes.contains(cell.cell.scene)) scenes[cell.cell.scene] = identify(cell.source);
    const Record* record = find_record(records, cell.cell);
    const fs::path run = run_folder(folder, cell.cell);
    cells.push_back({cell, cell_stages(cell, profile, scenes[cell.cell.scene], record, run), record}
    );
  }
  return cells;
}

}  // namespace glint
