// SPDX-License-Identifier: MIT
// A cell in a process of its own, and what became of it.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "reports/run/bench/child_process.h"
#include "reports/run/executors/cell_queue.h"
#include "reports/run/executors/executor.h"

namespace glint {

class CellProcess {
 public:
  // `settings` join its environment.
  CellProcess(
      const CellTry& what,
      const RunnerOptions& options,
      const ExecutorOptions& how,
      const ProcessShare& share,
      ChildProcess::Words settings
  );

  const CellTry& what() const { return what_; }
  int output() const { return child_.output(); }
  // Takes what the process has written; shows it.
  void read();
  // Past the time limit: told to stop first, which leaves a checkpoint, then killed.
  void heed_time();
  // The same from outside: the run is to end.
  void stop(int signal);

  struct Outcome {
    std::optional<Record> record;  // what it says of itself, or what can be said of it
    bool written = false;          // the record is in the records already
    bool reused = false;           // nothing was left to do
    bool elsewhere = false;        // another process is at the cell
    bool stopped = false;          // as it was told by stop()
  };
  // Nothing: it is still running.
  std::optional<Outcome> outcome();

 private:
  using Clock = std::chrono::steady_clock;

  std::optional<Record> own_record() const;
  Failure failure_of(const ProcessEnd& end) const;
  std::string kind_of(const ProcessEnd& end) const;
  std::string message_of(const ProcessEnd& end) const;
  std::string stage() const;
  void show(const std::string& text);

  const RunnerOptions& options_;
  const ExecutorOptions& how_;
  CellTry what_;
  fs::path run_, records_file_;
  std::uintmax_t records_bytes_;  // when it began
  std::uint64_t memory_kills_;    // when it began
  bool timed_out_ = false, told_ = false;
  Clock::time_point begin_, told_at_;
  std::string tail_, line_;  // the end of its output; an unfinished line of it
  ChildProcess child_;
};

}  // namespace glint
