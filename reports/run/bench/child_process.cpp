// SPDX-License-Identifier: MIT
#include "reports/run/bench/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <utility>

#include "glint/core/error.h"
#include "glint/core/file_lock.h"

namespace glint {
namespace {

// Pointers to words, as exec() takes them.
std::vector<char*> pointers_to(const std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (const std::string& word : words) pointers.push_back(const_cast<char*>(word.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

// A setting stands in for one of the same name.
std::vector<std::string> environment_with(const std::vector<std::string>& settings) {
  std::vector<std::string> all = settings;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry, name = text.substr(0, text.find('=') + 1);
    bool replaced = false;
    for (const std::string& setting : settings) replaced = replaced || setting.starts_with(name);
    if (!replaced) all.push_back(text);
  }
  return all;
}

// An open file of this process, closed with the object; -1: none.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int number() const { return number_; }
  int release() { return std::exchange(number_, -1); }
  void close() {
    if (number_ >= 0) ::close(release());
  }

 private:
  int number_;
};

std::array<int, 2> open_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return {-1, -1};
  return ends;
}

struct Pipe {
  Descriptor read, write;
  explicit Pipe(const std::array<int, 2>& ends = open_pipe()) : read(ends[0]), write(ends[1]) {}
  bool is_open() const { return read.number() >= 0; }
};

// Between fork() and exec() only calls that are safe in a signal handler are allowed.
[[noreturn]] void become(
    const char* program,
    char* const* words,
    char* const* environment,
    int output,
    int failure,
    pid_t parent
) {
  ::setpgid(0, 0);
  ::signal(SIGPIPE, SIG_IGN);  // whoever reads the output may end first, and this one's work not
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(127);  // it has ended already
  const int score = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (score >= 0) {
    [[maybe_unused]] const auto written = ::write(score, "500", 3);
    ::close(score);
  }
  ::dup2(output, STDOUT_FILENO);
  ::dup2(output, STDERR_FILENO);
  const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (nothing >= 0) ::dup2(nothing, STDIN_FILENO);
  environ = const_cast<char**>(environment);
  ::execvp(program, words);
  const int why = errno;
  [[maybe_unused]] const auto written = ::write(failure, &why, sizeof why);
  ::_exit(127);
}

// errno of an exec() that failed, 0 of one that did not: then the pipe has closed by itself.
int wait_for_exec(int failure) {
  int why = 0;
  while (::read(failure, &why, sizeof why) < 0 && errno == EINTR) {
  }
  return why;
}

class TimeLimit {
 public:
  explicit TimeLimit(double seconds) : seconds_(seconds) {}
  bool is_over() const {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin_;
    return seconds_ > 0 && passed.count() > seconds_;
  }

 private:
  double seconds_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

ProcessEnd end_of(int status) {
  if (WIFSIGNALED(status)) return {0, WTERMSIG(status)};
  return {WEXITSTATUS(status), 0};
}

}  // namespace

ChildProcess::ChildProcess(const Words& words, const Words& settings) {
  Words with_parent = settings;
  with_parent.push_back(fmt::format("{}={}", kWorksFor, ::getpid()));
  const std::vector<std::string> environment = environment_with(with_parent);
  Words shown = words;
  if (words.at(0) == kThisProgram) shown[0] = program_invocation_short_name;
  const auto word_pointers = pointers_to(shown), environment_pointers = pointers_to(environment);
  Pipe output, failure;
  const pid_t parent = ::getpid();
  id_ = output.is_open() && failure.is_open() ? ::fork() : -1;
  const int no_process = errno;
  if (id_ == 0)
    become(
        words[0].c_str(),
        word_pointers.data(),
        environment_pointers.data(),
        output.write.number(),
        failure.write.number(),
        parent
    );
  output.write.close();
  failure.write.close();
  const int why = id_ < 0 ? no_process : wait_for_exec(failure.read.number());
  if (why == 0) {
    output_ = output.read.release();
    ::fcntl(output_, F_SETFL, O_NONBLOCK);
    return;
  }
  if (id_ > 0) ::waitpid(id_, nullptr, 0);
  throw Error(
      ExitCode::kEnvironment,
      fmt::format("{}: cannot be started ({})", words.at(0), std::strerror(why))
  );
}

ChildProcess::~ChildProcess() {
  if (output_ >= 0) ::close(output_);
  if (id_ < 0 || end_) return;
  ::kill(-id_, SIGKILL);
  ::waitpid(id_, nullptr, 0);
}

std::string ChildProcess::read() {
  std::array<char, 4096> block{};
  std::string text;
  while (output_ >= 0) {
    const ssize_t bytes = ::read(output_, block.data(), block.size());
    if (bytes > 0) {
      text.append(block.data(), static_cast<std::size_t>(bytes));
      continue;
    }
    const bool later = bytes < 0 && (errno == EAGAIN || errno == EINTR);
    if (!later) ::close(std::exchange(output_, -1));
    break;
  }
  return text;
}

// To the whole group: what the child started goes with it.
void ChildProcess::send(int signal) const {
  if (id_ > 0 && !end_) ::kill(-id_, signal);
}

std::optional<ProcessEnd> ChildProcess::end() {
  if (end_ || id_ < 0) return end_;
  int status = 0;
  const pid_t ended = ::waitpid(id_, &status, WNOHANG);
  if (ended == id_) end_ = end_of(status);
  if (ended < 0 && errno == ECHILD) end_ = ProcessEnd{};
  return end_;
}

std::optional<CommandResult> run_command(
    const ChildProcess::Words& words, const ChildProcess::Words& settings, double seconds
) {
  constexpr int kPollMilliseconds = 100;
  try {
    ChildProcess child(words, settings);
    CommandResult result;
    const TimeLimit limit(seconds);
    while (child.output() >= 0 && !limit.is_over()) {
      pollfd waiting{child.output(), POLLIN, 0};
      ::poll(&waiting, 1, kPollMilliseconds);
      result.output += child.read();
    }
    while (!child.end()) {
      if (limit.is_over()) child.send(SIGKILL);
      ::usleep(1000);
    }
    result.end = *child.end();
    return result;
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::string signal_name(int signal) {
  const char* name = ::sigabbrev_np(signal);
  return name != nullptr ? fmt::format("SIG{}", name) : fmt::format("signal {}", signal);
}

}  // namespace glint
