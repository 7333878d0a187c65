// SPDX-License-Identifier: MIT
// The cells of a profile (scene x method x seed), filtered, and what is known about each.
#pragma once

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
  Json config;              // overrides for MethodSpec::create
  std::string config_hash;  // method, resolved config, iterations, seed and the code's sources
};

// Cells scene by scene, so that each scene is loaded once. Errors (kUsage): unknown method, a
// config field that the method does not know, filters that leave nothing.
std::vector<PlanCell> make_plan(
    const Profile& profile, const CellFilter& filter, const std::vector<std::string>& assignments
);

enum class CellState { kDone, kFailed, kStale, kPending };
// kStale: a record exists, but of another configuration, code or dataset. An empty `dataset_hash`
// (not made yet) compares as equal to any.
CellState state_of(
    const PlanCell& cell, const std::vector<Record>& records, const std::string& dataset_hash
);
std::string_view state_name(CellState state);  // "done", "failed", "stale", "pending"

// Seconds the cell will take, from the mean of finished cells of the same method; 0: unknown.
double estimated_seconds(const PlanCell& cell, const std::vector<Record>& records);

}  // namespace glint
