// SPDX-License-Identifier: MIT
// What `all` is told about cells.
#pragma once

#include <string>
#include <vector>

#include "reports/run/executors/executor.h"
#include "reports/verbs/verb.h"

namespace glint {

struct CellRunOptions {
  bool force = false;
  std::string executor = "local";
  int jobs = 1;
  std::string time_limit;          // of a cell: "90s", "30m", "4h"; empty: none
  std::string time_for_all;        // likewise, of all of them
  std::string order;               // "longest", "given"; empty: as ExecutorOptions has it
  std::vector<std::string> cells;  // "scene/method/seed"
  std::string cells_file;          // more of them, one a line; empty: none
  std::string tasks;               // a file of them, of which line `task` is run; empty: none
  std::size_t task = 0;
  bool data_only = false, no_tables = false;
  std::string parcels;  // folder for parcels of cells that ended; empty: none
  int max_failures = 0;
  std::vector<std::string> sbatch;
};

// The cells of a profile, then tables, figures and page unless it is told otherwise.
int run_all(const CommonOptions& common, const CellRunOptions& how);

// `options` must live as long as `verb`.
void add_cell_run_options(CLI::App& verb, CellRunOptions& options);

// Errors (kUsage): a cell of --cell, --cells or --tasks that the profile does not have, no such
// file or line.
RunnerOptions runner_options(const CommonOptions& common, const CellRunOptions& how);

// Cells of published datasets whose scenes are not below `data_folder` are told once, not one by
// one, and left out of the filter. Returns how many. Errors (kBadReference): no other cell is left.
int leave_out_missing(const fs::path& data_folder, RunnerOptions& options);

// Runs the cells that `options` chooses and whose data are there, by the executor that is asked
// for. Where other processes run them, those take the device, and this one does not. Errors:
// run_profile()'s and choose_device()'s; kUsage: no such executor, order or time.
RunSummary run_cells(
    const CommonOptions& common, const CellRunOptions& how, const RunnerOptions& options
);

// 0; 5: some failed, had no data, were not begun or are another process's; 128 + signal:
// interrupted.
int exit_code_of(const RunSummary& summary);

Json summary_json(const RunSummary& summary);
// "2 run, 1 reused, 0 failed".
std::string summary_text(const RunSummary& summary);

// Seconds of "90", "90s", "30m", "4h", "2d". Errors (kUsage): something else.
double parse_duration(const std::string& option, const std::string& text);

}  // namespace glint
