// SPDX-License-Identifier: MIT
#include "reports/verbs/doctor_card.h"

#include "glint/core/device.h"
#include "glint/cuda/backend.h"
#include "glint/cuda/require_gpu.h"
#include "reports/run/executors/mps_server.h"
#include "reports/run/records/environment.h"

namespace glint {
namespace {

std::string gib_text(double bytes) { return fmt::format("{:.1f} GiB", bytes / (1 << 30)); }

Checked no_card(bool needed, bool asked_for) {
  const std::string why = "no: " + gpu::cuda_device().why_not;
  if (!needed) return {"cuda", CheckState::kOk, why};
  return {
      "cuda",
      CheckState::kBad,
      why,
      asked_for ? "use --device cpu" : "GLINT_REQUIRE_GPU is set; unset it to work on the CPU"};
}

Checked card() {
  const gpu::CudaDevice& device = gpu::cuda_device();
  const std::string free =
      on_gpu() ? fmt::format(" ({} free)", gib_text(static_cast<double>(device_room()))) : "";
  return {
      "cuda",
      CheckState::kOk,
      fmt::format(
          "{}, {}{}, driver for CUDA {}",
          device.name,
          gib_text(static_cast<double>(device.memory_bytes)),
          free,
          device.driver
      )};
}

// Whether cells on this card can run side by side.
Checked mps() {
  const std::string control = mps_control().string();
  if (control.empty())
    return {
        "mps",
        CheckState::kNote,
        "not found: cells on a GPU run one after the other",
        fmt::format("{} comes with NVIDIA's driver; put it on PATH", kMpsControl)};
  if (mps_servers())
    return {
        "mps",
        CheckState::kNote,
        fmt::format("a daemon answers already ({}): cells use it", mps_folder()),
        fmt::format("end it (echo quit | {}) where it is not meant for them", kMpsControl)};
  if (gpu::cuda_device().exclusive)
    return {
        "mps",
        CheckState::kNote,
        control +
            "; the card is set to serve one process at a time: while --jobs 2 or more use it "
            "by MPS, no other process can",
        "'nvidia-smi -c DEFAULT' lets others share it"};
  return {"mps", CheckState::kOk, control};
}

}  // namespace

std::vector<Checked> examine_card(const std::string& device) {
  check_device_name(device);
  const bool asked_for = device == "cuda";
  if (!gpu::cuda_device().usable) {
    std::vector<Checked> rows{no_card(asked_for || gpu::gpu_required(), asked_for)};
    if (asked_for) rows.push_back(mps());
    return rows;
  }
  choose_device(device);
  return {card(), mps()};
}

Json card_json() {
  const gpu::CudaDevice& device = gpu::cuda_device();
  return {
      {"usable", device.usable},
      {"why_not", device.why_not},
      {"name", device.name},
      {"free_bytes", static_cast<double>(device_room())}};
}

}  // namespace glint
