// SPDX-License-Identifier: MIT
// Every kernel, compiled for the host once for all tests.
#include <cstring>

#include "glint/cuda/ops.h"
#include "tests/support/gpu_backends.h"
#include "tests/support/host_exec.h"

namespace glint::test {
namespace {

// Memory operations of kernels on the host.
struct HostDeviceOps {
  static void copy(void* to, const void* from, std::size_t bytes) {
    const OpenMemory open(OpenMemory::kBoth);
    std::memcpy(to, from, bytes);
  }
  static void clear(void* block, std::size_t bytes) {
    const OpenMemory open(OpenMemory::kDevice);
    std::memset(block, 0, bytes);
  }
  static void fill(float* to, std::size_t count, float value) {
    const OpenMemory open(OpenMemory::kDevice);
    std::fill_n(to, count, value);
  }
};

}  // namespace

void use_host_kernels() {
  static const DeviceBackend backend{
      .name = "kernels on the host",
      .allocate = HostDeviceMemory::allocate,
      .release = HostDeviceMemory::release,
      .upload = HostDeviceOps::copy,
      .download = HostDeviceOps::copy,
      .copy = HostDeviceOps::copy,
      .clear = HostDeviceOps::clear,
      .fill = HostDeviceOps::fill,
      .synchronize = [] {},
      .room = [] { return host_memory().room; },
      .peak = [] { return HostDeviceMemory::pool().peak_bytes(); },
      .reset_peak = [] { HostDeviceMemory::pool().reset_peak(); },
      .allocate_host = [](std::size_t bytes) { return host_memory().host.allocate(bytes); },
      .release_host = [](void* block) noexcept { host_memory().host.release(block); }};
  gpu::use_executor<HostExec>(backend);
}

}  // namespace glint::test
