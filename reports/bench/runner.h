// SPDX-License-Identifier: MIT
// Runs the cells of a profile and appends a record for each. A cell that fails becomes a record
// too, and the next one starts: an unattended night gives every number that can be had.
#pragma once

#include <map>

#include "reports/bench/plan.h"
#include "reports/bench/stages.h"

namespace glint {

struct RunnerOptions {
  Profile profile;
  CellFilter filter;
  std::vector<std::string> assignments;  // of --set
  fs::path out;                          // the profile's folder: records.jsonl, runs/, tables/
  bool force = false;                    // run finished cells again, training included
  bool rescore = false;  // runs that other code trained are rendered and scored, not trained again
  SceneLoader load;
};

struct RunSummary {
  int ran = 0, reused = 0, failed = 0;
  bool interrupted = false;
};

// Finished cells are reused when configuration, code and data hash alike; a cell that was trained
// but not scored is scored. Errors: kUsage from the plan, kEnvironment when records cannot be
// written.
RunSummary run_profile(const RunnerOptions& options);

struct RunScores {
  std::map<std::string, double> means;              // by id
  std::map<std::string, std::string> not_measured;  // id -> why
  std::vector<std::string> not_applicable;          // see not_applicable()
};
// Everything behind training: renders, strip, FPS, meshes, metrics.
RunScores render_and_score(
    const RunSpec& spec, const Scene& scene, Method& method, const Profile& profile
);

// Of a failure in `stage`: "bad-input", "usage", "environment", "not-finite" (training diverged),
// "out-of-memory", "unknown".
std::string failure_kind(const std::exception& error, const std::string& stage);

}  // namespace glint
