// SPDX-License-Identifier: MIT
#include "reports/records/environment.h"

#include <ctime>
#include <string>

#include "glint/core/device.h"
#include "glint/core/machine.h"
#include "glint/core/parallel.h"
#include "glint/core/progress.h"
#include "glint/cuda/backend.h"
#include "reports/records/revision.h"

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

}  // namespace

Json environment_json() {
  const Machine machine = this_machine();
  return {
      {"device", device_name()},
      {"driver", on_gpu() ? "CUDA " + gpu::cuda_device().driver : ""},
      {"cpu", machine.cpu},
      {"cores", machine.cores},
      {"threads", num_threads()},
      {"memory_bytes", machine.memory_bytes},
      {"compiler", fmt::format("g++ {}", __VERSION__)},
      {"git_revision", git_revision()},
      {"date", utc_now()}};
}

void choose_device(const std::string& requested, bool say_why) {
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
  else if (say_why)
    log::info("on the CPU: " + device.why_not);
}

}  // namespace glint
