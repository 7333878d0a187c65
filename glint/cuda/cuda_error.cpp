// SPDX-License-Identifier: MIT
#include "glint/cuda/cuda_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "glint/core/device_lost.h"

namespace glint::gpu {

namespace {

constexpr const char* kLess =
    "use fewer surfels (--set max_surfels=N), smaller images (--max-pixels) or --device cpu";
constexpr const char* kNewerDriver =
    "install a newer NVIDIA driver, or build with an older CUDA toolkit";
constexpr const char* kOtherProcess =
    "another process has this card, which is set to serve one at a time (nvidia-smi names it, "
    "'nvidia-smi -c DEFAULT' lets several share it)";
constexpr const char* kRebuild =
    "this program was not built for this card; configure with -DCMAKE_CUDA_ARCHITECTURES=native "
    "(scripts/bundle.sh --arch)";
constexpr const char* kLost = "the device is lost to this process; start it again";
constexpr const char* kBroken =
    "the device or its driver failed: see nvidia-smi and the kernel's log (dmesg, lines with Xid)";
constexpr const char* kMps =
    "MPS, by which processes share the card, has ended or failed (logs: CUDA_MPS_LOG_DIRECTORY); "
    "start it again, or run one process at a time";
constexpr const char* kFewerJobs = "MPS serves as many processes as it can; use fewer (--jobs)";
constexpr int kMemoryAllocation = 2;

// What is known of an error: numbers of cudaError_t, which do not change (driver_types.h).
struct Known {
  int error;
  const char* advice;
  bool lost = false;
};
constexpr Known kKnown[] = {
    {2, kLess},           // memory allocation
    {3, kBroken},         // initialization
    {35, kNewerDriver},   // insufficient driver
    {36, kNewerDriver},   // call requires newer driver
    {46, kOtherProcess},  // devices unavailable
    {100, "no card is seen: check nvidia-smi and CUDA_VISIBLE_DEVICES"},  // no device
    {209, kRebuild},                                                      // no kernel image
    {214, kBroken, true},   // uncorrectable error of the memory
    {216, kOtherProcess},   // device already in use
    {222, kNewerDriver},    // unsupported PTX version
    {226, kLost, true},     // contained
    {700, kLost, true},     // illegal address
    {702, kLost, true},     // launch timeout
    {709, kLost, true},     // context is destroyed
    {710, kLost, true},     // assert
    {714, kLost, true},     // hardware stack error
    {715, kLost, true},     // illegal instruction
    {716, kLost, true},     // misaligned address
    {717, kLost, true},     // invalid address space
    {718, kLost, true},     // invalid program counter
    {719, kLost, true},     // launch failure
    {802, kBroken},         // system not ready
    {803, kNewerDriver},    // system driver mismatch
    {804, kNewerDriver},    // compatibility not supported
    {805, kMps},            // no connection to MPS
    {806, kMps, true},      // a call of MPS failed
    {807, kMps},            // MPS takes no one yet
    {808, kFewerJobs},      // MPS has as many processes as it takes
    {809, kFewerJobs},      // MPS has as many connections as it takes
    {810, kMps, true},      // ended by MPS
    {911, kBroken, true},   // external device
    {999, kBroken, true}};  // unknown: after a card fell off the bus

const Known* find_known(int error) {
  const auto found = std::find_if(std::begin(kKnown), std::end(kKnown), [&](const Known& known) {
    return known.error == error;
  });
  return found == std::end(kKnown) ? nullptr : found;
}

std::string gib(std::size_t bytes) {
  return fmt::format("{:.2f} GiB", static_cast<double>(bytes) / (1 << 30));
}
std::string version_text(int version) {
  return fmt::format("{}.{}", version / 1000, version % 1000 / 10);
}

}  // namespace

std::string advice_for(int error) {
  const Known* known = find_known(error);
  return known == nullptr ? std::string() : known->advice;
}

bool loses_device(int error) {
  const Known* known = find_known(error);
  return known != nullptr && known->lost;
}

void throw_cuda_error(const char* what, const char* reason) { throw_cuda_error(what, 0, reason); }

void throw_cuda_error(const char* what, int error, const char* reason) {
  std::string message = fmt::format("CUDA: {} failed: {}", what, reason);
  if (const std::string advice = advice_for(error); !advice.empty()) message += "; " + advice;
  if (loses_device(error)) throw DeviceLost(message);
  if (error == kMemoryAllocation) throw OutOfMemory(message);
  throw Error(ExitCode::kEnvironment, message);
}

void throw_out_of_memory(std::size_t needed, std::size_t free, std::size_t total) {
  throw OutOfMemory(fmt::format(
      "the card is too small: {} are needed, {} of its {} are free; {}. Other processes on it: "
      "nvidia-smi",
      gib(needed),
      gib(free),
      gib(total),
      kLess
  ));
}

std::string driver_text(int driver, int runtime) {
  return fmt::format(
      "driver for CUDA {}, program for CUDA {}", version_text(driver), version_text(runtime)
  );
}

}  // namespace glint::gpu
