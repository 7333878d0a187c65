// SPDX-License-Identifier: MIT
#include "reports/run/bench/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <catch2/catch.hpp>

#include <csignal>

#include "glint/core/error.h"
#include "glint/core/files.h"
#include "tests/support/temp_folder.h"

using namespace glint;

namespace {

ProcessEnd end_of(ChildProcess& child) {
  while (!child.end()) ::usleep(1000);
  return *child.end();
}

std::string output_of(const ChildProcess::Words& words) {
  const auto result = run_command(words);
  REQUIRE(result);
  return result->output;
}

// Until the file has a line; a few seconds at most.
std::string first_line_of(const fs::path& file) {
  for (int i = 0; i < 500; ++i, ::usleep(10000))
    if (fs::exists(file))
      if (const std::string text = read_file(file); text.ends_with("\n"))
        return text.substr(0, text.find('\n'));
  return "";
}

int open_descriptors() {
  int count = 0;
  for (int number = 0; number < 256; ++number) count += ::fcntl(number, F_GETFD) >= 0 ? 1 : 0;
  return count;
}

// A user who may have no further process; false: this one cannot become such.
bool forbid_processes() {
  const rlimit none{0, 0};
  constexpr uid_t kNobody = 65534;  // of root, processes are not counted
  return ::setrlimit(RLIMIT_NPROC, &none) == 0 && (::geteuid() != 0 || ::setuid(kNobody) == 0);
}

// Files that are left open where no process can be made; -1: this cannot be brought about here.
int left_open_without_process() {
  if (!forbid_processes()) return -1;
  const int before = open_descriptors();
  try {
    const ChildProcess child({"true"});
    return -1;
  } catch (const Error&) {
    return open_descriptors() - before;
  }
}

}  // namespace

TEST_CASE("words reach a program as they are: no shell reads them") {
  const std::vector<std::string> hostile = {"a b", "$(id)", "; ls", "'", "\"", "*", ""};
  ChildProcess::Words words = {"printf", "[%s]"};
  words.insert(words.end(), hostile.begin(), hostile.end());
  CHECK(output_of(words) == "[a b][$(id)][; ls]['][\"][*][]");
}

TEST_CASE("standard output and error of a program come together") {
  CHECK(output_of({"sh", "-c", "echo out; echo error >&2"}) == "out\nerror\n");
}

TEST_CASE("how a process ended: by itself, or by a signal") {
  CHECK(run_command({"sh", "-c", "exit 3"})->end.code == 3);
  CHECK(run_command({"true"})->end.good());
  const auto killed = run_command({"sh", "-c", "kill -SEGV $$"});
  CHECK(killed->end.signal == SIGSEGV);
  CHECK_FALSE(killed->end.good());
  CHECK(signal_name(SIGSEGV) == "SIGSEGV");
  CHECK(signal_name(1000) == "signal 1000");
}

TEST_CASE("a program that is not there is an error that names it") {
  CHECK_FALSE(run_command({"glint-no-such-program"}));
  CHECK_THROWS_WITH(
      ChildProcess({"glint-no-such-program"}), Catch::Contains("glint-no-such-program: cannot be")
  );
}

TEST_CASE("where no process can be made, no file stays open") {
  const pid_t apart = ::fork();
  if (apart == 0) ::_exit(left_open_without_process() & 0xff);
  int status = 0;
  REQUIRE(::waitpid(apart, &status, 0) == apart);
  REQUIRE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 0xff)
    WARN("skipped: the number of processes cannot be limited here");
  else
    CHECK(WEXITSTATUS(status) == 0);
}

TEST_CASE("settings stand in for those of the environment") {
  ::setenv("GLINT_TEST_A", "old", 1);
  ChildProcess child({"sh", "-c", "echo $GLINT_TEST_A $HOME"}, {"GLINT_TEST_A=new"});
  end_of(child);
  CHECK(child.read() == fmt::format("new {}\n", std::getenv("HOME") ? std::getenv("HOME") : ""));
}

TEST_CASE("a program that takes longer than it may is killed, also one that others hold open") {
  for (const char* script : {"echo begun; sleep 60", "echo begun; sleep 60 & sleep 60"}) {
    const auto result = run_command({"sh", "-c", script}, {}, 0.3);
    REQUIRE(result);
    CHECK(result->output == "begun\n");
    CHECK(result->end.signal == SIGKILL);
  }
}

TEST_CASE("a signal reaches what a process has started, too") {
  const test::TempFolder folder;
  const std::string file = folder / "id";
  ChildProcess child({"sh", "-c", "sleep 60 & echo $! >" + file + "; wait"});
  const pid_t below = std::stoi(first_line_of(file));
  child.send(SIGKILL);
  CHECK(end_of(child).signal == SIGKILL);
  for (int i = 0; i < 500 && ::kill(below, 0) == 0; ++i) ::usleep(10000);
  CHECK(::kill(below, 0) != 0);
}

TEST_CASE("children are told to stop when the program that started them is killed") {
  const test::TempFolder folder;
  const std::string ready = folder / "ready", told = folder / "told";
  const pid_t parent = ::fork();
  if (parent == 0) {
    // Nobody reads what it says to that.
    const std::string script = "trap 'echo oh; echo no >&2; echo told >" + told +
                               "; exit' TERM; echo go >" + ready + "; while :; do sleep 0.05; done";
    const ChildProcess child({"sh", "-c", script});
    ::pause();
  }
  REQUIRE(first_line_of(ready) == "go");
  ::kill(parent, SIGKILL);
  ::waitpid(parent, nullptr, 0);
  CHECK(first_line_of(told) == "told");
}
