// SPDX-License-Identifier: MIT
// Ways to run the cells of a profile: in this process, in processes of their own, as jobs of a
// cluster. A file registers one:
//
//   GLINT_REGISTER(Executor, {"local", "...", run_local})
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "glint/core/registry.h"
#include "reports/run/bench/runner.h"

namespace glint {

// In which order cells begin.
enum class CellOrder {
  kGiven,    // of the filter's cells; where it names none, the plan's
  kLongest,  // those first that are expected to take longest
};

// What a process of a pool gets.
struct ProcessShare {
  int threads = 1;
  bool gpu = false;  // there is one: no other device will do
};

struct ExecutorOptions {
  int jobs = 1;                    // processes at a time
  double time_limit = 0;           // seconds that a cell may take; 0: any
  double time_for_all = 0;         // seconds after which no cell runs any more; 0: any
  int max_failures = 0;            // no cell begins after so many have failed; 0: any
  int threads = 1;                 // of all processes together
  std::optional<CellOrder> order;  // nothing: the longest first where several run at a time

  // The words that run one cell in a process of its own, with this program first.
  std::function<std::vector<std::string>(const CellKey& cell, bool force, const ProcessShare&)>
      command;
  // Those that print what the GPU is like (card_share.h); empty: the cells run on the CPU.
  std::vector<std::string> look_at_card;

  // For engines that start this program elsewhere: what every verb has to be told so that it is
  // about this profile, and what `all` has to be told beside that.
  std::vector<std::string> profile_words, run_words;
  std::vector<std::string> sbatch;  // options for sbatch, as "--partition=gpu"
  bool on_gpu = false;              // asked for by --device cuda

  CellOrder cell_order() const {
    return order.value_or(jobs > 1 ? CellOrder::kLongest : CellOrder::kGiven);
  }
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
