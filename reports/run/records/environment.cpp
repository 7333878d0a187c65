// SPDX-License-Identifier: MIT
#include "reports/run/records/environment.h"

#include <sys/utsname.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>

#include "glint/core/device.h"
#include "glint/core/machine.h"
#include "glint/core/parallel.h"
#include "glint/core/progress.h"
#include "glint/cuda/backend.h"
#include "glint/cuda/card_lock.h"
#include "metrics/metric.h"
#include "reports/run/records/build_info.h"
#include "reports/run/records/revision.h"

namespace glint {

namespace {

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

// "Debian GNU/Linux 12 (bookworm)"; "unknown" where it does not say.
std::string operating_system() {
  std::ifstream in("/etc/os-release");
  constexpr std::string_view kKey = "PRETTY_NAME=";
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(kKey)) continue;
    std::string name = line.substr(kKey.size());
    std::erase(name, '"');
    return name;
  }
  return "unknown";
}

// SHA-256 of the files behind metrics: the weights of LPIPS. Empty: there are none.
Json weights_json() try {
  Json weights = Json::object();
  for (const MetricFamily& family : metric_families())
    for (const Metric& metric : family.metrics)
      if (family.files)
        if (const Json found = family.files(metric).provenance; found.contains("sha256"))
          weights[metric.id] = found["sha256"];
  return weights;
} catch (const Error& error) {
  return {{"unusable", error.what()}};  // scoring says so, too
}

// Of the GPU in use; empty: on the CPU, from where no GPU is looked at: that would take a part of
// it.
std::string compute_capability() {
  if (!on_gpu()) return "";
  const int capability = gpu::cuda_device().compute_capability;
  return fmt::format("{}.{}", capability / 10, capability % 10);
}

// Those of a pool that have the GPU together, this one among them; 0: on the CPU.
int cells_on_card() {
  const char* together = std::getenv(gpu::kCardJobs);
  return !on_gpu() ? 0 : together == nullptr ? 1 : std::max(1, std::atoi(together));
}

}  // namespace

Json environment_json() {
  const Machine machine = this_machine();
  utsname system{};
  ::uname(&system);
  return {
      {"device", device_name()},
      {"driver", on_gpu() ? "CUDA " + gpu::cuda_device().driver : ""},
      {"compute_capability", compute_capability()},
      {"cells_on_card", cells_on_card()},
      {"machine", system.nodename},
      {"os", operating_system()},
      {"kernel", fmt::format("{} {}", system.sysname, system.release)},
      {"cpu", machine.cpu},
      {"cores", machine.cores},
      {"threads", num_threads()},
      {"memory_bytes", machine.memory_bytes},
      {"compiler", fmt::format("g++ {}", __VERSION__)},
      {"build_type", build_info().type},
      {"flags", build_info().flags},
      {"cuda", build_info().cuda},
      {"libraries", build_info().libraries},
      {"weights", weights_json()},
      {"git_revision", git_revision()},
      {"date", utc_now()}};
}

void check_device_name(const std::string& requested) {
  GLINT_CHECK(
      requested == "auto" || requested == "cpu" || requested == "cuda",
      kUsage,
      "--device {}: expected auto, cpu or cuda",
      requested
  );
}

void choose_device(const std::string& requested, bool say_why) {
  check_device_name(requested);
  if (requested == "cpu") return use_cpu();
  const gpu::CudaDevice& device = gpu::cuda_device();
  GLINT_CHECK(
      requested != "cuda" || device.usable,
      kEnvironment,
      "--device cuda: {}; use --device cpu",
      device.why_not
  );
  if (device.usable)
    gpu::use_cuda();
  else if (say_why)
    log::info("on the CPU: " + device.why_not);
}

}  // namespace glint
