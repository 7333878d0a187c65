// SPDX-License-Identifier: MIT
// How much disk and memory a profile takes: from what its finished runs took, else from sizes of
// pictures. Estimates, and named so.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reports/bench/plan.h"
#include "reports/records/profile.h"

namespace glint {

struct Estimate {
  double bytes = 0;
  std::string from;  // "3 finished runs", "sizes of pictures"
};

// Of the cells whose runs are not finished. `folder`: the profile's. Nothing: their data are
// folders of the user's, whose sizes are not known, and nothing has run.
std::optional<Estimate> disk_of_runs(
    const std::vector<PlanCell>& plan, const Profile& profile, const fs::path& folder
);

// Of rooms that have to be made.
double disk_of_room(const SceneSource& source);

// Of the largest of the planned cells, by what such cells took before, else by images and surfels
// of rooms. Nothing: their data are folders of the user's, and none has run.
std::optional<Estimate> memory_of_cells(
    const std::vector<PlanCell>& plan, const Profile& profile, const std::vector<Record>& records
);

}  // namespace glint
