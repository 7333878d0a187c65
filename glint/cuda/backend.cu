// SPDX-License-Identifier: MIT
#include "glint/cuda/backend.h"

#include <algorithm>

#include "glint/cuda/card_lock.h"
#include "glint/cuda/device_exec.cuh"
#include "glint/cuda/ops.h"

namespace glint::gpu {

namespace {

struct FillFloats {
  float* to;
  float value;
  GLINT_HD void operator()(std::size_t i) const { to[i] = value; }
};

// Memory of arrays: pages move to whoever touches them.
void* allocate(std::size_t bytes) {
  void* block = nullptr;
  check_cuda(cudaMallocManaged(&block, bytes), "allocating shared memory");
  return block;
}
void release(void* block) { cudaFree(block); }
void fill_floats(float* to, std::size_t count, float value) {
  executor<DeviceExec>().for_each(count, FillFloats{to, value});
}
void wait() { check_cuda(cudaDeviceSynchronize(), "waiting for the device"); }

std::string version_text(int version) {
  return std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
}

struct Nothing {
  GLINT_HD void operator()(std::size_t) const {}
};

// Whether a kernel of this program runs: drivers may be too old, devices too.
cudaError_t try_kernel() {
  run_elements<<<1, 32>>>(32, Nothing{});
  const cudaError_t launched = cudaGetLastError();
  return launched == cudaSuccess ? cudaDeviceSynchronize() : launched;
}

CudaDevice look() {
  CudaDevice device;
  int driver = 0, count = 0;
  cudaDriverGetVersion(&driver);
  if (driver == 0) {
    device.why_not = "no NVIDIA driver";
    return device;
  }
  device.driver = version_text(driver);
  cudaError_t status = cudaGetDeviceCount(&count);
  cudaDeviceProp properties{};
  if (status == cudaSuccess) status = cudaGetDeviceProperties(&properties, 0);
  if (status == cudaSuccess) status = try_kernel();
  if (status != cudaSuccess) {
    cudaGetLastError();  // forgotten
    device.why_not = driver_text(driver, CUDART_VERSION) + ": " + cudaGetErrorString(status);
    if (const std::string advice = advice_for(status); !advice.empty())
      device.why_not += "; " + advice;
    return device;
  }
  device.name = properties.name;
  device.compute_capability = 10 * properties.major + properties.minor;
  device.memory_bytes = properties.totalGlobalMem;
  device.usable = properties.concurrentManagedAccess != 0;
  if (!device.usable) device.why_not = device.name + " shares no memory with a running host";
  return device;
}

}  // namespace

const CudaDevice& cuda_device() {
  static const CudaDevice device = look();
  return device;
}

void use_cuda() {
  const CudaDevice& device = cuda_device();
  if (!device.usable) throw_cuda_error("finding a device", device.why_not.c_str());
  static const DeviceBackend backend{device.name.c_str(), allocate, release, fill_floats, wait};
  use_executor<DeviceExec>(backend);
  char card[32] = "";
  if (cudaDeviceGetPCIBusId(card, sizeof card, 0) == cudaSuccess) warn_of_sharing(card);
}

double measure_copy_bandwidth(std::size_t bytes) {
  constexpr int kRuns = 9;
  DeviceBuffer<char> from, to;
  from.resize(bytes);
  to.resize(bytes);
  cudaEvent_t begin, end;
  check_cuda(cudaEventCreate(&begin), "making an event");
  check_cuda(cudaEventCreate(&end), "making an event");
  float ms[kRuns];
  for (float& run : ms) {
    cudaEventRecord(begin);
    cudaMemcpyAsync(to.data(), from.data(), bytes, cudaMemcpyDeviceToDevice);
    cudaEventRecord(end);
    check_cuda(cudaEventSynchronize(end), "copying inside the device");
    check_cuda(cudaEventElapsedTime(&run, begin, end), "timing a copy");
  }
  cudaEventDestroy(begin);
  cudaEventDestroy(end);
  std::sort(ms, ms + kRuns);
  return 2 * static_cast<double>(bytes) / (static_cast<double>(ms[kRuns / 2]) * 1e-3);
}

}  // namespace glint::gpu
