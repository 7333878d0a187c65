// SPDX-License-Identifier: MIT
// One cell through those of its stages that are not done, to its record.
#pragma once

#include "reports/run/bench/cell_stages.h"
#include "reports/run/bench/runner.h"

namespace glint {

// `records`: of cells that have ended before, the cell's own last one among them. What fails
// becomes part of the record. Errors: Interrupted passes through, an unfinished cell leaves no
// record.
Record run_cell(
    const PlanCell& cell,
    const RunnerOptions& options,
    const LoadedScene& loaded,
    const CellStages& stages,
    const std::vector<Record>& records
);

// Of a cell whose data cannot be had.
Record record_without_data(
    const PlanCell& cell, const RunnerOptions& options, const std::exception& error
);

// Of a cell that failed in some other way: its process did not come so far as to say so.
Record failed_record(const PlanCell& cell, const RunnerOptions& options, Failure failure);

}  // namespace glint
