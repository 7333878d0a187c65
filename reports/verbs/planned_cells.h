// SPDX-License-Identifier: MIT
// The cells of a profile with what is done of each: for `status`.
#pragma once

#include "reports/bench/cell_stages.h"
#include "reports/verbs/verb.h"

namespace glint {

struct PlannedCell {
  PlanCell cell;
  CellStages stages;
  const Record* record;  // in `records` of the call; null: none
  // "done", "failed", "stale" (a record of something else), "pending"
  std::string state() const;
};

// `records` must outlive the cells. Errors: as make_plan, identify_source.
std::vector<PlannedCell> planned_cells(
    const CommonOptions& common, const Profile& profile, const std::vector<Record>& records
);

}  // namespace glint
