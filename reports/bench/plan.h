// SPDX-License-Identifier: MIT
// The cells of a profile (scene x method x seed), filtered, and how long each will take.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reports/records/profile.h"
#include "reports/records/records.h"

namespace glint {

struct CellFilter {
  std::vector<std::string> only, skip;  // globs; empty `only`: all
};

// A pattern matches a cell when it matches "scene/method/seed", "scene/method", the scene or the
// method. '*' also runs over '/'.
bool filter_accepts(const CellFilter& filter, const CellKey& cell);

struct PlanCell {
  CellKey cell;
  SceneSource source;
  Json config;  // overrides for MethodSpec::create
};

// Cells scene by scene, so that each scene is loaded once. Errors (kUsage): unknown method, a
// config field that the method does not know, filters that leave nothing.
std::vector<PlanCell> make_plan(
    const Profile& profile, const CellFilter& filter, const std::vector<std::string>& assignments
);

// Seconds that these stages of the cell will take, from the mean of finished cells of the same
// method. Nothing: unknown, none has finished.
std::optional<double> estimated_seconds(
    const PlanCell& cell, const std::vector<Record>& records, const std::vector<std::string>& stages
);

}  // namespace glint
