// SPDX-License-Identifier: MIT
#include "reports/run/executors/cell_process.h"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <sstream>
#include <utility>

#include "glint/core/machine.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"
#include "reports/run/bench/cell_run.h"
#include "reports/run/records/failure_kinds.h"
#include "reports/run/records/run_folder.h"

namespace glint {
namespace {

constexpr std::size_t kTailBytes = 8192, kTailLines = 30;
constexpr double kGraceSeconds = 60;  // to write a checkpoint

std::uintmax_t bytes_of_file(const fs::path& file) {
  return is_file(file) ? fs::file_size(file) : 0;
}

// Of what a terminal was shown: without the progress lines that were drawn over.
std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    while (!line.empty() && line.back() == '\r') line.pop_back();
    line = line.substr(line.rfind('\r') == std::string::npos ? 0 : line.rfind('\r') + 1);
    if (!line.empty()) lines.push_back(line);
  }
  if (lines.size() > kTailLines)
    lines.erase(lines.begin(), lines.end() - static_cast<std::ptrdiff_t>(kTailLines));
  return lines;
}

bool asks_to_stop(int signal) {
  return signal == SIGTERM || signal == SIGINT || signal == SIGUSR1 || signal == SIGHUP;
}

// The signal that ended the process, or that it heeded and ended itself on.
int signal_behind(const ProcessEnd& end) {
  if (end.signal != 0) return end.signal;
  return end.code > 128 && asks_to_stop(end.code - 128) ? end.code - 128 : 0;
}

ChildProcess start(
    const CellTry& what,
    const ExecutorOptions& how,
    const ProcessShare& share,
    ChildProcess::Words settings
) {
  if (how.jobs == 1 && ::isatty(STDERR_FILENO) != 0) settings.emplace_back(kDrawnProgress);
  return ChildProcess(how.command(what.cell->cell, what.force, share), settings);
}

}  // namespace

CellProcess::CellProcess(
    const CellTry& what,
    const RunnerOptions& options,
    const ExecutorOptions& how,
    const ProcessShare& share,
    ChildProcess::Words settings
)
    : options_(options),
      how_(how),
      what_(what),
      run_(run_folder(options.out, what.cell->cell)),
      records_file_(options.out / "records.jsonl"),
      records_bytes_(bytes_of_file(records_file_)),
      memory_kills_(out_of_memory_kills()),
      begin_(Clock::now()),
      child_(start(what, how, share, std::move(settings))) {}

void CellProcess::read() {
  const std::string text = child_.read();
  if (text.empty()) return;
  tail_ += text;
  if (tail_.size() > 2 * kTailBytes) tail_.erase(0, tail_.size() - kTailBytes);
  show(text);
}

// One at a time draws as it likes; of several each line says whose it is.
void CellProcess::show(const std::string& text) {
  if (how_.jobs == 1) {
    std::fwrite(text.data(), 1, text.size(), stderr);
    return;
  }
  line_ += text;
  for (std::size_t end = line_.find('\n'); end != std::string::npos; end = line_.find('\n')) {
    const std::string line = line_.substr(0, end);
    log::text(fmt::format("{}: {}\n", what_.cell->cell.text(), line));
    line_.erase(0, end + 1);
  }
}

void CellProcess::heed_time() {
  const auto seconds_since = [](Clock::time_point then) {
    return std::chrono::duration<double>(Clock::now() - then).count();
  };
  if (told_) {
    if (seconds_since(told_at_) > kGraceSeconds) child_.send(SIGKILL);
  } else if (how_.time_limit > 0 && seconds_since(begin_) > how_.time_limit) {
    timed_out_ = true;
    stop(SIGTERM);
  }
}

void CellProcess::stop(int signal) {
  if (std::exchange(told_, true)) return;  // a second signal would end it at once
  told_at_ = Clock::now();
  child_.send(signal);
}

std::optional<CellProcess::Outcome> CellProcess::outcome() {
  const auto end = child_.end();
  if (!end) return std::nullopt;
  read();
  Outcome outcome;
  outcome.record = own_record();
  if (outcome.record) {
    outcome.written = true;
  } else if (end->good()) {
    outcome.reused = true;
  } else if (end->code == static_cast<int>(ExitCode::kPartial)) {
    outcome.elsewhere = true;
  } else if (told_ && !timed_out_ && signal_behind(*end) != 0) {
    outcome.stopped = true;
  } else {
    outcome.record = failed_record(*what_.cell, options_, failure_of(*end));
  }
  return outcome;
}

// What it wrote itself since it began.
std::optional<Record> CellProcess::own_record() const {
  for (Record& record : read_records(records_file_, records_bytes_))
    if (record.cell == what_.cell->cell) return std::move(record);
  return std::nullopt;
}

Failure CellProcess::failure_of(const ProcessEnd& end) const {
  Failure failure;
  failure.stage = stage();
  failure.kind = kind_of(end);
  failure.message = message_of(end);
  failure.log_tail = log_tail(run_);
  failure.iteration = last_iteration(run_);
  failure.output_tail = lines_of(tail_);
  return failure;
}

std::string CellProcess::kind_of(const ProcessEnd& end) const {
  const int signal = signal_behind(end);
  if (timed_out_) return std::string(failure::kTimeout);
  if (asks_to_stop(signal)) return std::string(failure::kPreempted);
  if (signal == SIGKILL && out_of_memory_kills() > memory_kills_)
    return std::string(failure::kOutOfMemory);
  if (signal != 0) return std::string(failure::kCrash);
  if (end.code < 1 || end.code > static_cast<int>(ExitCode::kEnvironment))
    return std::string(failure::kCrash);
  return std::string(failure_kind(Error(static_cast<ExitCode>(end.code), ""), ""));
}

std::string CellProcess::message_of(const ProcessEnd& end) const {
  const int signal = signal_behind(end);
  if (timed_out_)
    return fmt::format("stopped after {} (--time-limit)", format_duration(how_.time_limit));
  if (signal == SIGKILL && out_of_memory_kills() > memory_kills_)
    return "ended by the kernel: the machine ran out of memory";
  if (asks_to_stop(signal)) return fmt::format("{} from outside", signal_name(signal));
  const auto lines = lines_of(tail_);
  const std::string last = lines.empty() ? "without a word" : lines.back();
  if (signal != 0) return fmt::format("{}; its last words: {}", signal_name(signal), last);
  constexpr std::string_view kError = "error: ";
  return last.starts_with(kError) ? last.substr(kError.size())
                                  : fmt::format("exit code {}: {}", end.code, last);
}

// The first stage that its folder has no key of.
std::string CellProcess::stage() const {
  for (const Stage stage : {Stage::kTrain, Stage::kRender, Stage::kMesh, Stage::kScore})
    if (!read_stage(run_, stage)) return std::string(stage_name(stage));
  return std::string(stage_name(Stage::kScore));
}

}  // namespace glint
