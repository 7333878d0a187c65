// SPDX-License-Identifier: MIT
// A pool of processes on this machine, one for each cell: a crash or the kernel's want of memory
// ends one cell.
#include <poll.h>

#include <algorithm>
#include <deque>
#include <list>

#include "glint/core/interrupt.h"
#include "glint/core/left_behind.h"
#include "glint/core/machine.h"
#include "glint/core/progress.h"
#include "reports/executors/cell_process.h"
#include "reports/executors/cell_queue.h"
#include "reports/records/failure_kinds.h"

namespace glint {
namespace {

constexpr int kPollMilliseconds = 50;

class LocalPool {
 public:
  LocalPool(const RunnerOptions& options, const ExecutorOptions& how)
      : options_(options),
        how_(how),
        plan_(make_plan(options.profile, options.filter, options.assignments)),
        queue_(plan_, options, how.jobs),
        memory_(static_cast<double>(available_memory_bytes())) {}

  RunSummary run() {
    remove_left_behind(options_.out, false);
    remove_left_behind(options_.out / "tables");
    summary_.reused = queue_.num_done();
    while (!running_.empty() || (!ends() && !queue_.empty())) {
      if (is_interrupted()) stop_all();
      while (!ends() && may_start()) start();
      wait();
      look_at_all();
    }
    summary_.interrupted = is_interrupted();
    summary_.not_begun = static_cast<int>(queue_.size());
    return summary_;
  }

 private:
  // No cell begins any more.
  bool ends() const {
    return is_interrupted() || (how_.max_failures > 0 && summary_.failed >= how_.max_failures);
  }

  // As many at a time as there are jobs, as far as their memory is known to suffice.
  bool may_start() const {
    if (queue_.empty() || running_.size() >= static_cast<std::size_t>(how_.jobs)) return false;
    if (running_.empty()) return true;
    if (queue_.front().alone) return false;
    double needed = queue_.bytes_of(*queue_.front().cell);
    for (const CellProcess& process : running_) {
      if (process.what().alone) return false;
      needed += queue_.bytes_of(*process.what().cell);
    }
    return needed <= memory_;
  }

  void start() {
    const CellTry what = queue_.take();
    log::info(queue_.place_of(what));
    running_.emplace_back(what, options_, how_, std::max(1, how_.threads / how_.jobs));
  }

  void stop_all() {
    for (CellProcess& process : running_) process.stop(interrupted_exit() - 128);
  }

  void wait() {
    std::vector<pollfd> outputs;
    for (const CellProcess& process : running_) outputs.push_back({process.output(), POLLIN, 0});
    ::poll(outputs.data(), outputs.size(), kPollMilliseconds);
  }

  void look_at_all() {
    for (auto process = running_.begin(); process != running_.end();) {
      process->read();
      process->heed_time();
      const auto outcome = process->outcome();
      if (outcome) finish(process->what(), *outcome);
      process = outcome ? running_.erase(process) : std::next(process);
    }
  }

  void finish(const CellTry& what, const CellProcess::Outcome& outcome) {
    if (outcome.stopped) return queue_.put_back(what);
    if (outcome.elsewhere) {
      if (!queue_.postpone(what)) ++summary_.elsewhere;
    } else if (outcome.reused) {
      ++summary_.reused;
    } else if (outcome.record->ok()) {
      ++summary_.ran;
      queue_.learn(*outcome.record);
    } else {
      fail(what, *outcome.record, outcome.written);
    }
  }

  void fail(const CellTry& what, Record record, bool written) {
    Failure& failure = *record.failure;
    failure.attempts = what.number;
    if (!written || what.number > 1) append_record(options_.out / "records.jsonl", record);
    const bool again = what.number <= failure_kind_of(failure.kind).retries && !is_interrupted();
    log::warn(fmt::format(
        "{} failed in {} ({}): {}{}",
        record.cell.text(),
        failure.stage,
        failure.kind,
        failure.message,
        again ? "; once more" : ""
    ));
    if (!again) {
      ++summary_.failed;
      return;
    }
    CellTry next = what;
    next.number = what.number + 1;
    next.alone = failure.kind == failure::kOutOfMemory;
    queue_.put_back(next);
  }

  const RunnerOptions& options_;
  const ExecutorOptions& how_;
  std::vector<PlanCell> plan_;
  CellQueue queue_;
  double memory_;  // bytes, when the pool began
  std::list<CellProcess> running_;
  RunSummary summary_;
};

RunSummary run_local(const RunnerOptions& options, const ExecutorOptions& how) {
  return LocalPool(options, how).run();
}

}  // namespace

GLINT_REGISTER(Executor, {"local", "a process for each cell, --jobs at a time", run_local})

}  // namespace glint
