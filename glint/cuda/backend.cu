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

void wait() { check_cuda(cudaDeviceSynchronize(), "waiting for the device"); }

MemoryPool& pool() {
  // Never destroyed: arrays of the program may outlive it.
  static MemoryPool& pool = *new MemoryPool(
      {[](std::size_t bytes) -> void* {
         void* block = nullptr;
         const cudaError_t status = cudaMalloc(&block, bytes);
         if (status == cudaSuccess) return block;
         // Errors of earlier kernels surface here, too: only a full device is the pool's to mend.
         if (status != cudaErrorMemoryAllocation) check_cuda(status, "allocating memory");
         cudaGetLastError();  // forgotten: the pool knows what to do
         return nullptr;
       },
       [](void* block) { cudaFree(block); },
       wait}
  );
  return pool;
}

void copy(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind, const char* what) {
  check_cuda(cudaMemcpyAsync(to, from, bytes, kind), what);
}
// `from` may change as soon as it returns, which an asynchronous copy from pages that are not
// locked does not promise.
void upload(void* to, const void* from, std::size_t bytes) {
  check_cuda(cudaMemcpy(to, from, bytes, cudaMemcpyHostToDevice), "copying to the device");
}
void download(void* to, const void* from, std::size_t bytes) {
  copy(to, from, bytes, cudaMemcpyDeviceToHost, "copying from the device");
  check_cuda(cudaStreamSynchronize(nullptr), "waiting for the device");
}
void copy_inside(void* to, const void* from, std::size_t bytes) {
  copy(to, from, bytes, cudaMemcpyDeviceToDevice, "copying inside the device");
}
void clear(void* block, std::size_t bytes) {
  check_cuda(cudaMemsetAsync(block, 0, bytes), "clearing memory");
}
void fill_floats(float* to, std::size_t count, float value) {
  executor<DeviceExec>().for_each(count, FillFloats{to, value});
}

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
  int mode = cudaComputeModeDefault;
  cudaDeviceGetAttribute(&mode, cudaDevAttrComputeMode, 0);
  device.exclusive = mode == cudaComputeModeExclusiveProcess;
  device.usable = true;
  return device;
}

}  // namespace

void* CudaMemory::allocate(std::size_t bytes) {
  void* block = pool().allocate(bytes);
  if (block != nullptr) return block;
  std::size_t free = 0, total = 0;
  check_cuda(cudaMemGetInfo(&free, &total), "asking for free memory");
  throw_out_of_memory(bytes, free, total);
}
void CudaMemory::release(void* block) noexcept { pool().release(block); }

const CudaDevice& cuda_device() {
  static const CudaDevice device = look();
  return device;
}

void use_cuda() {
  const CudaDevice& device = cuda_device();
  if (!device.usable) throw_cuda_error("finding a device", device.why_not.c_str());
  static const DeviceBackend backend{
      .name = device.name.c_str(),
      .allocate = CudaMemory::allocate,
      .release = CudaMemory::release,
      .upload = upload,
      .download = download,
      .copy = copy_inside,
      .clear = clear,
      .fill = fill_floats,
      .synchronize = wait,
      .room =
          [] {
            std::size_t free = 0, total = 0;
            check_cuda(cudaMemGetInfo(&free, &total), "asking for its free memory");
            return free + pool().bytes_held() - pool().bytes_in_use();
          },
      .peak = [] { return pool().peak_bytes(); },
      .reset_peak = [] { pool().reset_peak(); }};
  use_executor<DeviceExec>(backend);
  char card[32] = "";
  if (cudaDeviceGetPCIBusId(card, sizeof card, 0) == cudaSuccess) warn_of_sharing(card);
}

double measure_copy_bandwidth(std::size_t bytes) {
  constexpr int kRuns = 9;
  DeviceExec::Buffer<char> from, to;
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
