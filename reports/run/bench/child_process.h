// SPDX-License-Identifier: MIT
// Programs started by this one. Words go to them as they are: no shell reads them.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace glint {

// This program, even where its file has been replaced or moved since it began.
inline constexpr const char* kThisProgram = "/proc/self/exe";

// How a process ended: with `code`, or by `signal` when that is not 0.
struct ProcessEnd {
  int code = 0, signal = 0;
  bool good() const { return code == 0 && signal == 0; }
};

// A process in a group of its own, so that Ctrl-C on a terminal reaches this program alone. It gets
// SIGTERM when this program ends, however that ends, and is the first to go when the machine runs
// out of memory.
class ChildProcess {
 public:
  using Words = std::vector<std::string>;

  // `words[0]` is looked up on PATH, or a path; `settings` ("NAME=value") join the environment.
  // Standard output and error of the child come out of read(). Errors (kEnvironment): no process
  // can be made, or no such program.
  explicit ChildProcess(const Words& words, const Words& settings = {});
  ~ChildProcess();  // one that still runs is killed
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  int output() const { return output_; }  // to poll(); ready when read() gives something
  // What it wrote since; never waits. Empty: nothing yet, or nothing ever again.
  std::string read();
  void send(int signal) const;
  // Nothing: it is still running.
  std::optional<ProcessEnd> end();

 private:
  pid_t id_ = -1;
  int output_ = -1;
  std::optional<ProcessEnd> end_;
};

struct CommandResult {
  ProcessEnd end;
  std::string output;  // standard output and error
};

// Runs a program to its end; nothing when there is no such program. One that takes longer than
// `seconds` (0: any time) is killed, which is how it ends then.
std::optional<CommandResult> run_command(
    const ChildProcess::Words& words, const ChildProcess::Words& settings = {}, double seconds = 0
);

// "SIGSEGV"; "signal 99" of those without a name.
std::string signal_name(int signal);

}  // namespace glint
