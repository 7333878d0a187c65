// SPDX-License-Identifier: MIT
// How kernels are written: as a function of a block of threads, in phases with a barrier behind
// each. On the device every thread runs its part of a phase; tests run the same text on the host,
// one thread after the other (tests/support/host_exec.h). So nothing but launches, sorting and the
// few lines below is GPU-only.
//
// A kernel is a struct with kThreads, Shared (its block's shared memory) and
//   template <class Block> GLINT_HD void operator()(Block& block, Shared& shared) const;
// A Block offers
//   index                      of the block
//   PerThread<T>               a variable of each thread, v[thread], that lives across phases
//   each(f)                    f(thread) for every thread, then a barrier
//   any(f)                     whether f(thread) holds for some thread; a barrier on both sides
//   add(p, value)              *p += value, from many threads
//   add_over_warps<kN>(f, p)   f(thread, float out[kN]) for every thread, out zero before; where it
//                              returns true for some thread of a warp, p[i] += the warp's sum of
//                              out[i]; no barrier
#pragma once

#include <cstdint>

#include "glint/core/real.h"

namespace glint::gpu {

inline constexpr int kWarp = 32;

#if defined(__CUDACC__)

template <int kThreads>
class DeviceBlock {
 public:
  template <class T>
  struct PerThread {
    T value;
    __device__ T& operator[](int) { return value; }
  };
  int index;

  __device__ DeviceBlock() : index(static_cast<int>(blockIdx.x)) {}
  template <class F>
  __device__ void each(F&& f) {
    f(static_cast<int>(threadIdx.x));
    __syncthreads();
  }
  template <class F>
  __device__ bool any(F&& f) {
    return __syncthreads_or(f(static_cast<int>(threadIdx.x))) != 0;
  }
  __device__ void add(float* p, float value) { atomicAdd(p, value); }
  template <int kN, class F>
  __device__ void add_over_warps(F&& f, float* p) {
    float out[kN] = {};
    const bool has = f(static_cast<int>(threadIdx.x), out);
    if (__any_sync(~0u, has) == 0) return;
#pragma unroll
    for (int i = 0; i < kN; ++i) {
      for (int step = kWarp / 2; step > 0; step /= 2) out[i] += __shfl_down_sync(~0u, out[i], step);
      if (threadIdx.x % kWarp == 0) atomicAdd(p + i, out[i]);
    }
  }
};

template <class Body>
__global__ void __launch_bounds__(Body::kThreads) run_blocks(Body body) {
  __shared__ typename Body::Shared shared;
  DeviceBlock<Body::kThreads> block;
  body(block, shared);
}

template <class F>
__global__ void run_elements(std::size_t count, F f) {
  const std::size_t i = std::size_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (i < count) f(i);
}

#endif

}  // namespace glint::gpu
