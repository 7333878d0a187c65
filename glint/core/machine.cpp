// SPDX-License-Identifier: MIT
#include "glint/core/machine.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
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

}  // namespace

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

std::uint64_t free_disk_bytes(const fs::path& folder) {
  std::error_code code;
  fs::path existing = fs::absolute(folder, code);
  while (!fs::exists(existing, code) && existing.has_relative_path())
    existing = existing.parent_path();
  const fs::space_info space = fs::space(existing, code);
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
