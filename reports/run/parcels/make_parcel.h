// SPDX-License-Identifier: MIT
// Parcels of cells that have ended, written where they ran.
#pragma once

#include <functional>

#include "reports/run/bench/runner.h"

namespace glint {

// Writes parcels into a folder, for RunnerOptions::ended. A parcel that cannot be made is a
// warning: the cell's other results are there.
std::function<void(const EndedCell&)> parcel_writer(const fs::path& folder);

// Parcels of cells of the plan that have ended and have none of their last record: those whose
// process ended without a word and, unless only the failed ones are asked for, those that were
// finished before.
void write_missing_parcels(
    const RunnerOptions& options, const fs::path& folder, bool only_failed = false
);

// At most about `lines` lines of a log.jsonl, first and last among them, and those with events.
std::string thinned_log(const std::string& log, std::size_t lines);

}  // namespace glint
