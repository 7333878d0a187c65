// SPDX-License-Identifier: MIT
// Runs the cells of a profile and appends a record for each. A cell that fails becomes a record
// too, and the next one starts: an unattended night gives every number that can be had.
#pragma once

#include "reports/run/bench/plan.h"
#include "reports/run/records/scene_source.h"

namespace glint {

// A cell that has ended, finished or failed, and is recorded.
struct EndedCell {
  const Record& record;
  fs::path run;                               // its folder; may be missing where it failed
  std::function<const LoadedScene&()> scene;  // loaded when asked for. Errors: SceneLoader's
};

struct RunnerOptions {
  Profile profile;
  CellFilter filter;
  std::vector<std::string> assignments;  // of --set
  fs::path out;                          // the profile's folder: records.jsonl, runs/, tables/
  bool force = false;                    // run finished cells again, training included
  double checkpoint_seconds = 300;       // between checkpoints of a training
  int max_failures = 0;                  // no cell begins after so many have failed; 0: any
  bool announced = false;                // somebody else has named the cell: no line about that
  SceneIdentifier identify;
  SceneLoader load;
  std::function<void(const EndedCell&)> ended;  // told of each cell that this process ran
};

struct RunSummary {
  int ran = 0, reused = 0, failed = 0;
  int elsewhere = 0;     // another process was at them until the end
  int not_begun = 0;     // left because of an interrupt, or of too many failures
  int without_data = 0;  // of published datasets whose scenes are not there
  int submitted = 0;     // handed to a cluster, which runs them later
  bool interrupted = false;
};

// Only the stages of a cell run whose keys have changed (cell_stages.h); cells of which all are
// done are reused. Several processes may run one profile: each takes the cells that no other one is
// at, and comes back to those in the end. Errors: kUsage from the plan, kEnvironment when records
// cannot be written.
RunSummary run_profile(const RunnerOptions& options);

}  // namespace glint
