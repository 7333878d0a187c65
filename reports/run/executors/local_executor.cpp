// SPDX-License-Identifier: MIT
// A pool of processes on this machine, one for each cell: a crash or the kernel's want of memory
// ends one cell.
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <list>
#include <utility>

#include "glint/core/interrupt.h"
#include "glint/core/left_behind.h"
#include "glint/core/machine.h"
#include "glint/core/progress.h"
#include "reports/run/bench/device_of_cells.h"
#include "reports/run/executors/card_share.h"
#include "reports/run/executors/cell_process.h"
#include "reports/run/executors/cell_queue.h"
#include "reports/run/records/failure_kinds.h"

namespace glint {
namespace {

constexpr int kPollMilliseconds = 50;

// Since the pool began, of --for.
class TimeForAll {
 public:
  explicit TimeForAll(double seconds) : seconds_(seconds) {}

  bool is_limited() const { return seconds_ > 0; }
  double seconds_left() const {
    return seconds_ - std::chrono::duration<double>(Clock::now() - begin_).count();
  }
  bool is_up() const { return is_limited() && seconds_left() <= 0; }

 private:
  using Clock = std::chrono::steady_clock;
  double seconds_;
  Clock::time_point begin_ = Clock::now();
};

class LocalPool {
 public:
  LocalPool(const RunnerOptions& options, const ExecutorOptions& how)
      : options_(options),
        how_(how),
        plan_(make_plan(options.profile, options.filter, options.assignments)),
        card_(how),
        device_(card_.on_gpu() ? Device::kCuda : current_device()),
        queue_(plan_, options, how.cell_order()),
        memory_(static_cast<double>(available_memory_bytes())) {}

  RunSummary run() {
    remove_left_behind(options_.out, false);
    remove_left_behind(options_.out / "tables");
    summary_.reused = queue_.num_done();
    leave_out_too_long();
    if (!queue_.empty() && !ends()) card_.begin();
    while (!running_.empty() || (!ends() && !queue_.empty())) {
      heed_signals_and_time();
      while (may_start()) start();
      wait();
      look_at_all();
    }
    summary_.interrupted = is_interrupted();
    summary_.not_begun = static_cast<int>(queue_.size() + queue_.set_aside().size());
    if (time_.is_limited() && !summary_.interrupted) tell_what_is_left();
    return summary_;
  }

 private:
  // No cell begins any more.
  bool ends() const {
    return is_interrupted() || time_.is_up() ||
           (how_.max_failures > 0 && summary_.failed >= how_.max_failures);
  }

  void heed_signals_and_time() {
    card_.heed_end_of_mps();
    if (is_interrupted()) return stop_all(interrupted_exit() - 128);
    if (!time_.is_up() || running_.empty() || std::exchange(told_, true)) return;
    log::info(fmt::format(
        "--for {}: the time is up; {} running cells write checkpoints and stop",
        format_duration(how_.time_for_all),
        running_.size()
    ));
    stop_all(SIGTERM);
  }

  bool may_start() {
    if (ends() || running_.size() >= static_cast<std::size_t>(card_.jobs())) return false;
    leave_out_too_long();
    if (queue_.empty()) return false;
    return running_.empty() || fits_beside_others();
  }

  void leave_out_too_long() {
    if (time_.is_limited()) queue_.set_aside_longer_than(time_.seconds_left());
  }

  // As far as the memory that they take is known, of the machine and of the card.
  bool fits_beside_others() const {
    if (queue_.front().alone) return false;
    const PlanCell& next = *queue_.front().cell;
    double bytes = queue_.bytes_of(next), card_bytes = queue_.card_bytes_of(next);
    for (const CellProcess& process : running_) {
      if (process.what().alone) return false;
      bytes += queue_.bytes_of(*process.what().cell);
      card_bytes += queue_.card_bytes_of(*process.what().cell);
    }
    return bytes <= memory_ && (card_.free_bytes() == 0 || card_bytes <= card_.free_bytes());
  }

  void start() {
    const CellTry what = queue_.take();
    log::info(queue_.place_of(what, card_.jobs()));
    began_ = true;
    const ProcessShare share{std::max(1, how_.threads / card_.jobs()), card_.on_gpu()};
    running_.emplace_back(what, options_, how_, share, card_.settings());
  }

  void stop_all(int signal) {
    for (CellProcess& process : running_) process.stop(signal);
  }

  void tell_what_is_left() const {
    if (summary_.not_begun == 0) return;
    const std::string time = format_duration(how_.time_for_all);
    const auto shortest = queue_.shortest_set_aside();
    if (began_ || !shortest)
      return log::info(fmt::format(
          "--for {}: {} cells are left; the same command goes on", time, summary_.not_begun
      ));
    log::warn(fmt::format(
        "--for {} is too short for any of {} cells: {} takes about {}",
        time,
        summary_.not_begun,
        shortest->cell->cell.text(),
        format_duration(*queue_.seconds_of(*shortest->cell))
    ));
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
    if (!written && card_.on_gpu()) record.environment["device"] = card_.name();
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
    try_again(what, failure.kind);
  }

  // For want of memory alone, when the others have ended; so, too, what may be its neighbours'
  // doing on a card.
  void try_again(const CellTry& what, std::string_view kind) {
    CellTry next = what;
    next.number = what.number + 1;
    next.alone = kind == failure::kOutOfMemory ||
                 (kind == failure::kEnvironment && card_.on_gpu() && card_.jobs() > 1);
    if (next.alone)
      queue_.put_last(next);
    else
      queue_.put_back(next);
  }

  const RunnerOptions& options_;
  const ExecutorOptions& how_;
  TimeForAll time_{how_.time_for_all};
  std::vector<PlanCell> plan_;
  CardShare card_;  // outlives the cells
  DeviceOfCells device_;
  CellQueue queue_;
  double memory_;  // bytes, when the pool began
  std::list<CellProcess> running_;
  bool began_ = false;  // any cell did
  bool told_ = false;   // the cells, to stop
  RunSummary summary_;
};

RunSummary run_local(const RunnerOptions& options, const ExecutorOptions& how) {
  return LocalPool(options, how).run();
}

}  // namespace

GLINT_REGISTER(Executor, {"local", "a process for each cell, --jobs at a time", run_local})

}  // namespace glint
