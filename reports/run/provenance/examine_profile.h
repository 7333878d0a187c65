// SPDX-License-Identifier: MIT
// What a profile needs before the night: its data, weights, disk and memory.
#pragma once

#include <vector>

#include "reports/run/bench/plan.h"
#include "reports/run/provenance/checked.h"
#include "reports/run/records/scene_source.h"

namespace glint {

struct ProfileToExamine {
  Profile profile;
  std::vector<PlanCell> plan;
  fs::path folder, data;  // of the profile's results, and --data
  SceneIdentifier identify;
};

std::vector<Checked> examine_profile(const ProfileToExamine& examined);

}  // namespace glint
