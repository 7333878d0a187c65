// SPDX-License-Identifier: MIT
#include "reports/bench/machine.h"

#include <unistd.h>

#include <ctime>
#include <fstream>
#include <sstream>
#include <thread>

#include "glint/core/device.h"
#include "glint/core/parallel.h"
#include "glint/core/progress.h"
#include "glint/cuda/backend.h"
#include "reports/revision.h"

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

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
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

Json environment_json() {
  const Machine machine = this_machine();
  return {
      {"device", device_name()},
      {"cpu", machine.cpu},
      {"cores", machine.cores},
      {"threads", num_threads()},
      {"memory_bytes", machine.memory_bytes},
      {"compiler", fmt::format("g++ {}", __VERSION__)},
      {"git_revision", git_revision()},
      {"source_hash", source_hash()},
      {"date", utc_now()}};
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

void choose_device(const std::string& requested) {
  GLINT_CHECK(
      requested == "auto" || requested == "cpu" || requested == "cuda",
      kUsage,
      "--device {}: expected auto, cpu or cuda",
      requested
  );
  const gpu::CudaDevice& device = gpu::cuda_device();
  GLINT_CHECK(
      requested != "cuda" || device.usable,
      kEnvironment,
      "--device cuda: {}; use --device cpu",
      device.why_not
  );
  if (requested == "cpu") return use_cpu();
  if (device.usable)
    gpu::use_cuda();
  else
    log::info("on the CPU: " + device.why_not);
}

}  // namespace glint
