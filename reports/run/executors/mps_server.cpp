// SPDX-License-Identifier: MIT
#include "reports/run/executors/mps_server.h"

#include <poll.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "glint/core/error.h"
#include "glint/core/interrupt.h"
#include "glint/core/presence.h"
#include "glint/core/progress.h"

namespace glint {
namespace {

using Clock = std::chrono::steady_clock;
using Words = ChildProcess::Words;

constexpr double kAnswerSeconds = 10, kStartSeconds = 20, kEndSeconds = 20;
constexpr int kWaitMilliseconds = 50;
constexpr std::string_view kReady = "ready\n";
constexpr const char* kProcessFile = "nvidia-cuda-mps-control.pid";  // among the daemon's pipes
// Names of sockets have 107 bytes at most, and the daemon puts its own behind this.
constexpr std::size_t kLongestFolder = 60;

// A process of its own, since it has to outlive this program when that is killed: the system tells
// it so by SIGTERM, as the object's end does. $1: the folder.
constexpr const char* kKeeper = R"sh(told=
trap 'told=1' TERM INT HUP USR1
if ! nvidia-cuda-mps-control -d >"$1/said" 2>&1 </dev/null; then
  cat "$1/said"
  rm -rf "$1"
  exit 1
fi
echo ready
while [ -z "$told" ]; do sleep 1 & wait $!; done
echo quit | timeout -k 5 60 nvidia-cuda-mps-control >"$1/said" 2>&1 ||
  kill "$(cat "$1/pipe/nvidia-cuda-mps-control.pid")" 2>/dev/null
rm -rf "$1"
)sh";

double seconds_since(Clock::time_point then) {
  return std::chrono::duration<double>(Clock::now() - then).count();
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

// Sockets lie in it, so a long TMPDIR will not do. Only its owner may look into it.
fs::path make_folder() {
  std::error_code code;
  fs::path parent = fs::temp_directory_path(code);
  if (code || parent.string().size() > kLongestFolder) parent = "/tmp";
  std::string pattern = (parent / "glint-mps-XXXXXX").string();
  GLINT_CHECK(
      ::mkdtemp(pattern.data()) != nullptr,
      kEnvironment,
      "{}: cannot be made ({})",
      pattern,
      std::strerror(errno)
  );
  return pattern;
}

// The daemon has the one card that this program would use, and numbers it anew: the first.
struct VisibleCard {
  std::string to_daemon, to_clients;
};
VisibleCard visible_card() {
  const std::string all = variable("CUDA_VISIBLE_DEVICES");
  const std::string first = all.empty() ? "0" : all.substr(0, all.find(','));
  const bool is_number = first.find_first_not_of("0123456789") == std::string::npos;
  return {first, is_number ? "0" : first};
}

// What a program wrote, as a part of one line.
std::string in_one_line(const std::string& text) {
  std::istringstream lines(text);
  std::string joined;
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) joined += (joined.empty() ? "" : "; ") + line;
  return joined;
}

}  // namespace

fs::path mps_control() {
  std::istringstream folders(variable("PATH"));
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path file = fs::path(folder) / kMpsControl;
    if (!folder.empty() && ::access(file.c_str(), X_OK) == 0) return file;
  }
  return {};
}

std::string mps_folder() {
  const std::string set = variable("CUDA_MPS_PIPE_DIRECTORY");
  return set.empty() ? "/tmp/nvidia-mps" : set;
}

std::optional<std::string> mps_servers(const Words& settings) {
  if (mps_control().empty()) return std::nullopt;
  const Words words = {"sh", "-c", "echo get_server_list | " + std::string(kMpsControl)};
  const auto result = run_command(words, settings, kAnswerSeconds);
  if (!result || !result->end.good()) return std::nullopt;
  return in_one_line(result->output);
}

MpsServer::MpsServer() {
  GLINT_CHECK(
      !mps_control().empty(),
      kEnvironment,
      "{} is not on PATH; it comes with NVIDIA's driver",
      kMpsControl
  );
  folder_ = make_folder();
  const VisibleCard card = visible_card();
  settings_ = {
      "CUDA_MPS_PIPE_DIRECTORY=" + (folder_ / "pipe").string(),
      "CUDA_MPS_LOG_DIRECTORY=" + (folder_ / "log").string(),
      "CUDA_VISIBLE_DEVICES=" + card.to_daemon};
  fs::create_directory(folder_ / "pipe");
  fs::create_directory(folder_ / "log");
  keeper_.emplace(Words{"sh", "-c", kKeeper, "glint-mps", folder_.string()}, settings_);
  settings_.back() = "CUDA_VISIBLE_DEVICES=" + card.to_clients;
  const std::string why = wait_until_ready();
  if (why.empty()) return;
  keeper_.reset();
  fs::remove_all(folder_);
  throw Error(ExitCode::kEnvironment, fmt::format("{} -d: {}", kMpsControl, why));
}

// Why it is not; empty: it is.
std::string MpsServer::wait_until_ready() {
  std::string said;
  for (const auto begin = Clock::now(); seconds_since(begin) < kStartSeconds;) {
    pollfd waiting{keeper_->output(), POLLIN, 0};
    ::poll(&waiting, 1, kWaitMilliseconds);
    said += keeper_->read();
    const fs::path file = folder_ / "pipe" / kProcessFile;
    if (said.ends_with(kReady)) {
      if (is_there(file)) process_ = in_one_line(read_file(file));
      return "";
    }
    if (const auto end = keeper_->end())
      return in_one_line(said).empty() ? fmt::format("exit code {}", end->code) : in_one_line(said);
    if (is_interrupted()) return "interrupted";
  }
  return fmt::format("not ready within {} s", kStartSeconds);
}

MpsServer::~MpsServer() {
  keeper_->send(SIGTERM);
  const auto begin = Clock::now();
  while (!keeper_->end() && seconds_since(begin) < kEndSeconds) ::usleep(10'000);
  if (!keeper_->end()) {
    log::warn(fmt::format("MPS does not end within {} s; its daemon is killed", kEndSeconds));
    const int process = std::atoi(process_.c_str());
    if (process > 1) ::kill(process, SIGTERM);
  }
  std::error_code code;
  fs::remove_all(folder_, code);
}

// Of a process that has ended, and that nobody has asked how, there is no program any more.
bool MpsServer::is_alive() const {
  if (process_.empty()) return true;
  std::error_code code;
  [[maybe_unused]] const fs::path program =
      fs::read_symlink(fs::path("/proc") / process_ / "exe", code);
  return code != std::errc::no_such_file_or_directory;
}

}  // namespace glint
