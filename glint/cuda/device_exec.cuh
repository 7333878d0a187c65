// SPDX-License-Identifier: MIT
// Runs kernels on the current CUDA device, in one stream. Buffers grow and never shrink, so that a
// steady state allocates nothing.
#pragma once

#include <cuda_runtime.h>

#include <cstdint>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>
#include <utility>

#include "glint/core/device.h"
#include "glint/core/kernel_trace.h"
#include "glint/cuda/block.h"
#include "glint/cuda/cuda_error.h"
#include "glint/cuda/device_buffer.h"

namespace glint::gpu {

inline void check_cuda(cudaError_t status, const char* what) {
  if (status != cudaSuccess) throw_cuda_error(what, status, cudaGetErrorString(status));
}

// The device's memory, from a pool; errors (kEnvironment): there is no room.
struct CudaMemory {
  static void* allocate(std::size_t bytes);
  static void release(void* block) noexcept;
};

class DeviceExec {
 public:
  template <class T>
  using Buffer = DeviceBuffer<T, CudaMemory>;

  explicit DeviceExec(cudaStream_t stream = nullptr) : stream_(stream) {}

  // Waits for the device.
  template <class T>
  void download(const Buffer<T>& from, std::size_t count, T* to) {
    if (count == 0) return;
    ++device_counters.downloads;
    ++device_counters.waits;
    check_cuda(
        cudaMemcpyAsync(to, from.data(), count * sizeof(T), cudaMemcpyDeviceToHost, stream_),
        "copying from the device"
    );
    check_cuda(cudaStreamSynchronize(stream_), "waiting for the device");
  }
  template <class T>
  void fill_zero(Buffer<T>& buffer) {
    if (buffer.size() == 0) return;
    check_cuda(
        cudaMemsetAsync(buffer.data(), 0, buffer.size() * sizeof(T), stream_), "clearing memory"
    );
  }
  template <class F>
  void for_each(std::size_t count, F f) {
    constexpr unsigned kThreads = 256;
    if (count == 0) return;
    ++device_counters.launches;
    const TracedKernel traced(typeid(F), stream_);
    const auto blocks = static_cast<unsigned>((count + kThreads - 1) / kThreads);
    run_elements<<<blocks, kThreads, 0, stream_>>>(count, f);
    check_cuda(cudaGetLastError(), "launching a kernel");
  }
  template <class Body>
  void launch(std::size_t blocks, const Body& body) {
    if (blocks == 0) return;
    ++device_counters.launches;
    const TracedKernel traced(typeid(Body), stream_);
    run_blocks<<<static_cast<unsigned>(blocks), Body::kThreads, 0, stream_>>>(body);
    check_cuda(cudaGetLastError(), "launching a kernel");
  }
  // sums[i] = counts[0] + ... + counts[i - 1] for i in [0, count], added by `add`.
  template <class T, class Add = Plus>
  void exclusive_sum_on_device(
      const Buffer<T>& counts, std::size_t count, Buffer<T>& sums, Add add = {}
  ) {
    sums.resize(count + 1);
    check_cuda(cudaMemsetAsync(sums.data(), 0, sizeof(T), stream_), "clearing memory");
    if (count == 0) return;
    const TracedKernel traced(typeid(ExclusiveSum), stream_);
    with_scratch([&](void* scratch, std::size_t& bytes) {
      return cub::DeviceScan::InclusiveScan(
          scratch, bytes, counts.data(), sums.data() + 1, add, static_cast<int>(count), stream_
      );
    });
  }
  // Stable, by the low `bits` bits of the keys, 32-bit or 64-bit ones.
  template <class Key>
  void sort_pairs(std::size_t count, int bits, Buffer<Key>& keys, Buffer<std::uint32_t>& values) {
    if (count == 0) return;
    Buffer<Key>& other_keys = other_keys_of(keys);
    other_keys.resize(count);
    other_values_.resize(count);
    const auto n = static_cast<int>(count);
    const TracedKernel traced(typeid(SortPairs), stream_);
    with_scratch([&](void* scratch, std::size_t& bytes) {
      return cub::DeviceRadixSort::SortPairs(
          scratch,
          bytes,
          keys.data(),
          other_keys.data(),
          values.data(),
          other_values_.data(),
          n,
          0,
          bits,
          stream_
      );
    });
    std::swap(keys, other_keys);
    std::swap(values, other_values_);
  }

 private:
  struct ExclusiveSum {};  // CUB's kernels, as KernelTrace names them
  struct SortPairs {};

  Buffer<std::uint32_t>& other_keys_of(Buffer<std::uint32_t>&) { return other_short_keys_; }
  Buffer<std::uint64_t>& other_keys_of(Buffer<std::uint64_t>&) { return other_keys_; }

  // CUB: once to ask for the size of its scratch memory, once to run.
  template <class F>
  void with_scratch(F&& run) {
    std::size_t bytes = 0;
    check_cuda(run(nullptr, bytes), "asking CUB for its memory");
    scratch_.resize(bytes);
    ++device_counters.launches;
    check_cuda(run(scratch_.data(), bytes), "running CUB");
  }

  cudaStream_t stream_;
  Buffer<char> scratch_;
  Buffer<std::uint64_t> other_keys_;
  Buffer<std::uint32_t> other_short_keys_, other_values_;
};

}  // namespace glint::gpu
