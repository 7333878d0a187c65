// SPDX-License-Identifier: MIT
// gpu-probe: what card and driver these are, whether a kernel runs, and what launches, allocations
// and copies cost. Without anything else of ours, so that it tells a broken machine from a broken
// program. A line each, "name value"; exit code 6 where there is no usable device.
#include <cuda_runtime.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

constexpr int kEnvironment = 6;  // ExitCode::kEnvironment
constexpr int kRuns = 9;
constexpr std::size_t kMiB = std::size_t{1} << 20;
constexpr std::size_t kCopy = 256 * kMiB;  // beyond the card's caches

void check(cudaError_t status, const char* what) {
  if (status == cudaSuccess) return;
  const std::string error = cudaGetErrorString(status);
  throw std::runtime_error(std::string(what) + ": " + error + " (" + std::to_string(status) + ")");
}

__global__ void count_up(int* values, int n) {
  const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (i < n) values[i] += i;
}

// Median microseconds of what waits for the device itself.
template <class F>
double microseconds(F&& f) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> times;
  f();
  for (int i = 0; i < kRuns; ++i) {
    const auto start = Clock::now();
    f();
    times.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
  }
  std::nth_element(times.begin(), times.begin() + kRuns / 2, times.end());
  return times[kRuns / 2];
}

void wait() { check(cudaDeviceSynchronize(), "waiting for the device"); }

void tell_attributes() {
  const std::pair<const char*, cudaDeviceAttr> attributes[] = {
      {"multiprocessors", cudaDevAttrMultiProcessorCount},
      {"registers_per_multiprocessor", cudaDevAttrMaxRegistersPerMultiprocessor},
      {"shared_bytes_per_multiprocessor", cudaDevAttrMaxSharedMemoryPerMultiprocessor},
      {"shared_bytes_per_block", cudaDevAttrMaxSharedMemoryPerBlockOptin},
      {"threads_per_multiprocessor", cudaDevAttrMaxThreadsPerMultiProcessor},
      {"l2_bytes", cudaDevAttrL2CacheSize},
      {"memory_bus_bits", cudaDevAttrGlobalMemoryBusWidth},
      {"clock_khz", cudaDevAttrClockRate},
      {"memory_clock_khz", cudaDevAttrMemoryClockRate},
      {"ecc", cudaDevAttrEccEnabled},
      {"compute_mode", cudaDevAttrComputeMode},  // 0: shared, 3: one process
      {"memory_pools", cudaDevAttrMemoryPoolsSupported},
      {"managed_memory", cudaDevAttrManagedMemory},
      {"concurrent_managed_access", cudaDevAttrConcurrentManagedAccess},
      {"kernel_timeout", cudaDevAttrKernelExecTimeout}};
  for (const auto& [name, attribute] : attributes) {
    int value = 0;
    if (cudaDeviceGetAttribute(&value, attribute, 0) == cudaSuccess)
      std::printf("%s %d\n", name, value);
  }
}

void tell_device() {
  int driver = 0, runtime = 0, count = 0;
  check(cudaDriverGetVersion(&driver), "asking for the driver");
  check(cudaRuntimeGetVersion(&runtime), "asking for the runtime");
  std::printf("driver_cuda %d\nruntime_cuda %d\n", driver, runtime);
  check(cudaGetDeviceCount(&count), "counting devices");
  cudaDeviceProp device{};
  check(cudaGetDeviceProperties(&device, 0), "looking at device 0");
  std::printf("devices %d\nname %s\n", count, device.name);
  std::printf("compute_capability %d.%d\n", device.major, device.minor);
  tell_attributes();
  std::size_t free = 0, total = 0;
  check(cudaMemGetInfo(&free, &total), "asking for free memory");
  std::printf("memory_bytes %zu\nmemory_free_bytes %zu\n", total, free);
}

// A kernel's results, read back.
void run_kernel_once() {
  constexpr int kCount = 1000;
  int* values = nullptr;
  std::vector<int> found(kCount);
  check(cudaMalloc(&values, kCount * sizeof(int)), "allocating memory");
  check(cudaMemset(values, 0, kCount * sizeof(int)), "clearing memory");
  count_up<<<(kCount + 255) / 256, 256>>>(values, kCount);
  check(cudaGetLastError(), "launching a kernel");
  check(cudaMemcpy(found.data(), values, kCount * sizeof(int), cudaMemcpyDeviceToHost), "reading");
  check(cudaFree(values), "freeing memory");
  for (int i = 0; i < kCount; ++i)
    if (found[static_cast<std::size_t>(i)] != i) {
      std::fprintf(stderr, "gpu-probe: a kernel ran and wrote the wrong numbers\n");
      std::exit(kEnvironment);
    }
  std::printf("kernel ran\n");
  std::fflush(stdout);
}

void time_launches() {
  constexpr int kMany = 1000;
  int* value = nullptr;
  check(cudaMalloc(&value, sizeof(int)), "allocating memory");
  const auto launch = [&] { count_up<<<1, 32>>>(value, 1); };
  std::printf("launch_and_wait_us %.2f\n", microseconds([&] { launch(), wait(); }));
  const double many = microseconds([&] {
    for (int i = 0; i < kMany; ++i) launch();
    wait();
  });
  std::printf("launch_us %.3f\n", many / kMany);
  cudaFree(value);
}

void time_allocations() {
  for (const std::size_t mib : {1, 64, 1024}) {
    const double plain = microseconds([&] {
      void* block = nullptr;
      check(cudaMalloc(&block, mib * kMiB), "allocating memory");
      check(cudaFree(block), "freeing memory");
    });
    const double pooled = microseconds([&] {
      void* block = nullptr;
      check(cudaMallocAsync(&block, mib * kMiB, nullptr), "allocating from the pool");
      check(cudaFreeAsync(block, nullptr), "freeing to the pool");
      wait();
    });
    std::printf("malloc_free_%zu_mib_us %.1f\npool_%zu_mib_us %.1f\n", mib, plain, mib, pooled);
  }
}

void time_copies() {
  void *a = nullptr, *b = nullptr, *pinned = nullptr;
  check(cudaMalloc(&a, kCopy), "allocating memory");
  check(cudaMalloc(&b, kCopy), "allocating memory");
  check(cudaMallocHost(&pinned, kCopy), "pinning memory of the host");
  std::vector<char> pageable(kCopy);
  const auto tell = [&](const char* name, void* to, const void* from, int bytes_moved) {
    const double us = microseconds([&] {
      check(cudaMemcpyAsync(to, from, kCopy, cudaMemcpyDefault), "copying");
      wait();
    });
    std::printf("%s_gb_per_s %.1f\n", name, bytes_moved * static_cast<double>(kCopy) / us * 1e-3);
  };
  tell("copy_on_device", a, b, 2);  // read and written
  tell("upload_pinned", a, pinned, 1);
  tell("download_pinned", pinned, a, 1);
  tell("upload_pageable", a, pageable.data(), 1);
  tell("download_pageable", pageable.data(), a, 1);
  cudaFreeHost(pinned);
  cudaFree(b);
  cudaFree(a);
}

}  // namespace

// What a card does not have room for, or does not do, says nothing about our kernels.
int main() try {
  tell_device();
  run_kernel_once();
  for (void (*time)() : {time_launches, time_allocations, time_copies}) try {
      time();
    } catch (const std::runtime_error& error) {
      std::printf("not_measured %s\n", error.what());
      cudaGetLastError();  // forgotten
    }
  return 0;
} catch (const std::runtime_error& error) {
  std::fprintf(stderr, "gpu-probe: %s\n", error.what());
  return kEnvironment;
}
