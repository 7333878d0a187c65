// SPDX-License-Identifier: MIT
// Stand-ins for NVIDIA's MPS and for a GPU, where there is neither.
#pragma once

#include <cstdlib>

#include "reports/run/executors/mps_server.h"
#include "tests/reports/run/executors/pool.h"

namespace glint::test {

// A variable of the environment, until the end of the test. Empty: not set.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    set(value);
  }
  ~Variable() { set(before_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  void set(const std::string& value) const {
    if (value.empty())
      ::unsetenv(name_);
    else
      ::setenv(name_, value.c_str(), 1);
  }
  const char* name_;
  std::string before_;
};

// The program on PATH: its daemon is a process that sleeps; a server is there as soon as a client
// has left the file "client" among the pipes. Each call leaves its command in asked(). `how`: "",
// "fails" (no daemon starts), "deaf" (no server comes).
class FakeMps {
 public:
  explicit FakeMps(const std::string& how = "")
      : path_("PATH", folder_.path().string() + ":" + std::getenv("PATH")),
        temporary_("TMPDIR", (folder_ / "tmp").string()),
        place_("FAKE_MPS", folder_.path().string()),
        how_("FAKE_MPS_HOW", how),
        pipes_("CUDA_MPS_PIPE_DIRECTORY", (folder_ / "none").string()) {
    fs::create_directories(folder_ / "tmp");
    const fs::path program = folder_ / kMpsControl;
    write_file(program, kScript);
    fs::permissions(program, fs::perms::owner_all);
  }

  const fs::path& path() const { return folder_.path(); }
  std::vector<std::string> asked() const { return lines_of_file(folder_ / "asked"); }
  int count(const std::string& command) const {
    const auto lines = asked();
    return static_cast<int>(std::count(lines.begin(), lines.end(), command));
  }
  // Folders that daemons were started in and that are still there.
  std::size_t folders_left() const {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(folder_ / "tmp"))
      count += entry.path().filename().string().starts_with("glint-mps-") ? 1 : 0;
    return count;
  }
  // A daemon that was there before, where this environment says.
  void start_daemon() const {
    fs::create_directories(mps_folder());
    REQUIRE(run_command({kMpsControl, "-d"})->end.good());
    write_file(fs::path(mps_folder()) / "client", "");
  }

 private:
  static constexpr const char* kScript = R"sh(#!/bin/sh
pipes=$CUDA_MPS_PIPE_DIRECTORY
process=$pipes/nvidia-cuda-mps-control.pid
if [ "$1" = -d ]; then
  echo start >>"$FAKE_MPS/asked"
  [ "$FAKE_MPS_HOW" != fails ] || { echo "not permitted"; exit 1; }
  setsid sleep 1000 >/dev/null 2>&1 &
  echo $! >"$process"
  exit 0
fi
read command
echo "$command" >>"$FAKE_MPS/asked"
[ -e "$process" ] && kill -0 "$(cat "$process")" || { echo "Cannot find MPS control daemon process"; exit 1; }
case $command in
  get_server_list) [ ! -e "$pipes/client" ] || [ "$FAKE_MPS_HOW" = deaf ] || echo 4711;;
  quit*) kill "$(cat "$process")"; rm "$process";;
esac
)sh";

  TempFolder folder_;
  Variable path_, temporary_, place_, how_, pipes_;
};

// What prints what such a GPU is like, and is a client of MPS.
inline std::vector<std::string> look_at_fake_card(double free_bytes) {
  return {
      "sh",
      "-c",
      R"sh([ ! -d "$CUDA_MPS_PIPE_DIRECTORY" ] || : >"$CUDA_MPS_PIPE_DIRECTORY/client"; echo "$0")sh",
      fmt::format(R"({{"schema": 1, "cuda": {{"usable": true, "free_bytes": {}}}}})", free_bytes)};
}
inline std::vector<std::string> look_at_no_card() {
  return {"echo", R"({"cuda": {"usable": false, "why_not": "no NVIDIA driver"}})"};
}

}  // namespace glint::test
