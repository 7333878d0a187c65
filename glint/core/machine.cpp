// SPDX-License-Identifier: MIT
#include "glint/core/machine.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <limits>
#include <sstream>
#include <thread>

namespace glint {

namespace {

// The text behind "key:" or "key\t:" in a file of /proc; empty when absent.
std::string proc_field(const char* file, std::string_view key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const std::size_t colon = line.find(':');
    if (line.rfind(key, 0) != 0 || colon == std::string::npos) continue;
    const std::size_t start = line.find_first_not_of(" \t", colon + 1);
    return start == std::string::npos ? "" : line.substr(start);
  }
  return "";
}

// The text behind "key " at the start of a line; empty when absent.
std::string proc_word(const char* file, std::string_view key) {
  std::ifstream in(file);
  std::string word, value;
  while (in >> word && std::getline(in, value))
    if (word == key) return value;
  return "";
}

// The first number of a file: of "max", which stands for no limit, and of no file, the largest.
std::uint64_t number_in(const fs::path& file) {
  std::uint64_t value = 0;
  std::ifstream in(file);
  return in >> value ? value : std::numeric_limits<std::uint64_t>::max();
}

// Of the control group (version 2) that this process is in: its limit less what it takes, page
// cache aside, which gives way.
std::uint64_t room_in_group() {
  std::ifstream in("/proc/self/cgroup");
  std::string line;
  while (std::getline(in, line) && !line.starts_with("0::")) {
  }
  if (line.size() < 4) return std::numeric_limits<std::uint64_t>::max();
  const fs::path group = fs::path("/sys/fs/cgroup") / line.substr(4);
  const std::uint64_t limit = number_in(group / "memory.max");
  if (limit == std::numeric_limits<std::uint64_t>::max()) return limit;
  std::uint64_t cached = 0;
  std::istringstream(proc_word((group / "memory.stat").c_str(), "inactive_file")) >> cached;
  const std::uint64_t used = number_in(group / "memory.current");
  return used > limit + cached ? 0 : limit + cached - used;
}

}  // namespace

std::uint64_t available_memory_bytes() {
  std::istringstream field(proc_field("/proc/meminfo", "MemAvailable"));  // "123456 kB"
  std::uint64_t kib = 0;
  field >> kib;
  return std::min(kib * 1024, room_in_group());
}

std::uint64_t resident_memory_bytes() {
  std::istringstream field(proc_field("/proc/self/status", "VmRSS"));  // "123456 kB"
  std::uint64_t kib = 0;
  field >> kib;
  return kib * 1024;
}

std::uint64_t out_of_memory_kills() {
  std::uint64_t kills = 0;
  std::istringstream(proc_word("/proc/vmstat", "oom_kill")) >> kills;
  return kills;
}

bool process_has_ended(int process) {
  if (::kill(process, 0) != 0 && errno == ESRCH) return true;
  std::ifstream file(fmt::format("/proc/{}/stat", process));
  std::string text;
  std::getline(file, text);
  const std::size_t name_end = text.rfind(')');  // "12 (a name) Z ..."
  return name_end != std::string::npos && text.substr(name_end + 1).starts_with(" Z");
}

std::string host_name() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

Machine this_machine() {
  Machine machine;
  machine.cpu = proc_field("/proc/cpuinfo", "model name");
  if (machine.cpu.empty()) machine.cpu = "unknown";
  machine.cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  machine.has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  machine.memory_bytes = static_cast<std::uint64_t>(::sysconf(_SC_PHYS_PAGES)) *
                         static_cast<std::uint64_t>(::sysconf(_SC_PAGE_SIZE));
  return machine;
}

fs::path nearest_existing(const fs::path& folder) {
  std::error_code code;
  fs::path existing = fs::absolute(folder, code).lexically_normal();
  while (!fs::exists(existing, code) && existing.has_relative_path())
    existing = existing.parent_path();
  return existing;
}

std::uint64_t free_disk_bytes(const fs::path& folder) {
  std::error_code code;
  const fs::space_info space = fs::space(nearest_existing(folder), code);
  return code ? 0 : space.available;
}

void reset_peak_memory() {
  std::ofstream("/proc/self/clear_refs") << 5;  // resets VmHWM (proc(5))
}

double peak_memory_mb() {
  std::istringstream field(proc_field("/proc/self/status", "VmHWM"));  // "123456 kB"
  double kib = 0;
  field >> kib;
  return kib * 1024 / 1e6;
}

}  // namespace glint
