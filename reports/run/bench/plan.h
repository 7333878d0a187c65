// SPDX-License-Identifier: MIT
// The cells of a profile (scene x method x seed), filtered, and how long each will take.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reports/run/records/cell_filter.h"
#include "reports/run/records/profile.h"
#include "reports/run/records/records.h"

namespace glint {

struct PlanCell {
  CellKey cell;
  SceneSource source;
  Json config;  // overrides for MethodSpec::create
};

// Cells scene by scene, so that each scene is loaded once; of the profile's methods, or those that
// --methods names (planned_methods). Errors (kUsage): unknown method, a config field that the
// method does not know, filters that leave nothing.
std::vector<PlanCell> make_plan(
    const Profile& profile, const CellFilter& filter, const std::vector<std::string>& assignments
);

// Of a picture, for each surfel of a set: about what rooms train to.
inline constexpr double kPixelsPerSurfel = 1.5;

// Seconds that these stages of the cell will take, from the mean of finished cells of the same
// method. Nothing: unknown, none has finished.
std::optional<double> estimated_seconds(
    const PlanCell& cell, const std::vector<Record>& records, const std::vector<std::string>& stages
);

}  // namespace glint
