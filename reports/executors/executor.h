// SPDX-License-Identifier: MIT
// Ways to run the cells of a profile: in this process, in processes of their own, as jobs of a
// cluster. A file registers one:
//
//   GLINT_REGISTER(Executor, {"local", "...", run_local})
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "glint/core/registry.h"
#include "reports/bench/runner.h"

namespace glint {

struct ExecutorOptions {
  int jobs = 1;           // processes at a time
  double time_limit = 0;  // seconds that a cell may take; 0: any
  int max_failures = 0;   // no cell begins after so many have failed; 0: any
  int threads = 1;        // of all processes together

  // The words that run one cell in a process of its own, with this program first.
  std::function<std::vector<std::string>(const CellKey& cell, bool force, int threads)> command;

  // For engines that start this program elsewhere: what every verb has to be told so that it is
  // about this profile, and what `run` has to be told beside that.
  std::vector<std::string> profile_words, run_words;
  std::vector<std::string> sbatch;  // options for sbatch, as "--partition=gpu"
  bool on_gpu = false;              // asked for by --device cuda
};

// How often a cell fails before it is given up is a matter of its failures' kinds
// (failure_kinds.h). Errors: run_profile()'s.
struct Executor {
  std::string id, title;
  RunSummary (*run)(const RunnerOptions& options, const ExecutorOptions& how);
};

// Errors (kUsage): no such executor; the message lists those there are.
const Executor& find_executor(const std::string& id);

}  // namespace glint
