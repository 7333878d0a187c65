// SPDX-License-Identifier: MIT
#include <fmt/ranges.h>

#include "glint/core/error.h"
#include "glint/core/machine.h"
#include "glint/core/parallel.h"
#include "glint/cuda/backend.h"
#include "glint/cuda/require_gpu.h"
#include "glint/drawing/canvas.h"
#include "metrics/feature_net.h"

#include "metrics/lpips_weights.h"
#include "reports/figures/figures.h"
#include "reports/records/environment.h"
#include "reports/records/revision.h"
#include "reports/verbs/verb.h"

namespace glint {

namespace {

constexpr std::uint64_t kGiB = std::uint64_t{1} << 30;
constexpr std::uint64_t kNeededDisk = 2 * kGiB;  // a profile on rooms stays well below
constexpr std::uint64_t kNeededMemory = 2 * kGiB;

struct Examined {
  std::string name, value;
  bool good = true;
  std::string advice;  // when not good
};

std::string gib(std::uint64_t bytes) {
  return fmt::format("{:.1f} GiB", static_cast<double>(bytes) / static_cast<double>(kGiB));
}

// No device is no failure, but where there has to be one.
Examined cuda() {
  const gpu::CudaDevice& device = gpu::cuda_device();
  if (!device.usable)
    return {
        "cuda",
        "no: " + device.why_not,
        !gpu::gpu_required(),
        "GLINT_REQUIRE_GPU is set; unset it to work on the CPU"};
  const std::string text = fmt::format(
      "{}, {}, driver for CUDA {}", device.name, gib(device.memory_bytes), device.driver
  );
  return {"cuda", text, true, ""};
}

// Which networks LPIPS has weights of.
Examined lpips_weights() {
  const fs::path place = lpips_weights_place();
  if (place.empty()) return {"lpips", "off: its columns will say 'no weights'", true, ""};
  std::vector<std::string> found;
  try {
    for (const LpipsNetwork& network : lpips_networks())
      if (lpips_weights_at(place, network.name) != nullptr) found.push_back(network.name);
  } catch (const Error& error) {
    return {"lpips", error.what(), false, "mend or remove the file"};
  }
  if (!found.empty()) return {"lpips", fmt::format("{}", fmt::join(found, ", ")), true, ""};
  return {
      "lpips", fmt::format("no weights at {}: its columns will say so", place.string()), true, ""};
}

// Of figures. Another font is no failure: only their look differs.
Examined font() {
  const std::string found = figures_font.here() ? figures_font() : "";
  if (found.empty()) return {"font", "off: this build draws no figures", true, ""};
  if (found == kFontFamily) return {"font", found, true, ""};
  return {
      "font", fmt::format("{} in place of {}: install fonts-inter", found, kFontFamily), true, ""};
}

std::vector<Examined> examine(const CommonOptions& common) {
  const Machine machine = this_machine();
  const std::uint64_t disk = free_disk_bytes(common.out);
  return {
      {"cpu", machine.cpu, true, ""},
      {"avx2",
       machine.has_avx2 ? "yes" : "no",
       machine.has_avx2,
       "the CPU kernels need AVX2 and FMA; use another machine"},
      {"threads", fmt::format("{} of {}", num_threads(), machine.cores), true, ""},
      {"memory",
       gib(machine.memory_bytes),
       machine.memory_bytes >= kNeededMemory,
       "2 GiB are needed; use smaller images"},
      {"disk",
       fmt::format("{} free for {}", gib(disk), common.out),
       disk >= kNeededDisk,
       "2 GiB are needed; free some or choose another --out"},
      cuda(),
      {"networks", feature_net_libraries(), true, ""},
      lpips_weights(),
      font(),
      {"revision", git_revision(), true, ""}};
}

int run_doctor(const CommonOptions& common) {
  bool good = true;
  Json json = Json::object();
  std::string text;
  for (const Examined& examined : examine(common)) {
    good &= examined.good;
    json[examined.name] = {{"value", examined.value}, {"ok", examined.good}};
    text += fmt::format(
        "{:<9} {:<5} {}\n", examined.name, examined.good ? "ok" : "BAD", examined.value
    );
    if (!examined.good) text += fmt::format("{:<15} {}\n", "", examined.advice);
  }
  if (common.json)
    print_json(json);
  else
    print_text(text);
  return static_cast<int>(good ? ExitCode::kSuccess : ExitCode::kEnvironment);
}

void add_doctor_verb(CommandLine& line) {
  line.add_verb(
      line.app,
      "doctor",
      "is this machine fit for it",
      [&line] { return run_doctor(line.common); },
      kOutOption | kDeviceOption | kThreadsOption | kJsonOption
  );
}

}  // namespace

GLINT_REGISTER(Verb, {"doctor", add_doctor_verb})

}  // namespace glint
