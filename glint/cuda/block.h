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
//   each_warp(f)               f(warp) for every warp, then a barrier; see below
//   add(p, value)              *p += value, from many threads: sums of whole numbers only, since
//                              others would differ from run to run
// A Warp is 32 threads, its lanes, in step with each other:
//   index, thread(lane)        of the warp in its block; of a lane in its block
//   PerLane<T>                 a variable of each lane, v[lane]
//   each(f)                    f(lane) for every lane; afterwards all see what they wrote
//   ballot(f)                  bit i: f(i), of lane i, holds
//   broadcast(v, lane)         v[lane], to all
//   match(v, masks)            masks[i]: the lanes with the value of lane i
//   sum(v)                     of all lanes, to all
//   sums<kN>(v, totals)        v: PerLane<Row<kN>>, totals: PerLane<Row<(kN + 31) / 32>>;
//                              totals[i].v[g] = sum of v[32 g + i] over the lanes, 0 behind kN
// Sums are those of a binary tree over the lanes, neighbours first: the same on every backend.
// Lanes must not part: what a warp calls depends on nothing that differs among its lanes.
#pragma once

#include <cstdint>

#include "glint/core/real.h"

namespace glint::gpu {

inline constexpr int kWarp = 32;

// Numbers of a lane. Indices known to the compiler keep them in registers.
template <int kN>
struct Row {
  float v[kN];
};

// How executors add what they sum, unless they are told otherwise.
struct Plus {
  template <class T>
  GLINT_HD T operator()(T a, T b) const {
    return a + b;
  }
};

// Transposed sums: lanes that differ in one bit of their number share the work. The one with the
// bit goes on with the odd ones of `count` values, the other with the even ones, each with the sums
// of both lanes; after five bits lane i has sum i. Value i of those that the lane goes on with:
GLINT_HD float half_of(const float* v, int count, bool odd, int i) {
  if (!odd) return v[2 * i];
  return 2 * i + 1 < count ? v[2 * i + 1] : 0.0f;
}

// Of a mask that is not 0.
GLINT_HD int lowest_bit(std::uint32_t mask) {
#if defined(__CUDA_ARCH__)
  return __ffs(static_cast<int>(mask)) - 1;
#else
  return __builtin_ctz(mask);
#endif
}
GLINT_HD int count_bits(std::uint32_t mask) {
#if defined(__CUDA_ARCH__)
  return __popc(mask);
#else
  return __builtin_popcount(mask);
#endif
}

#if defined(__CUDACC__)

class DeviceWarp {
 public:
  template <class T>
  struct PerLane {
    T value;
    __device__ T& operator[](int) { return value; }
  };
  int index;

  __device__ DeviceWarp() : index(static_cast<int>(threadIdx.x) / kWarp) {}
  __device__ int thread(int) const { return static_cast<int>(threadIdx.x); }
  template <class F>
  __device__ void each(F&& f) {
    f(lane());
    __syncwarp();
  }
  template <class F>
  __device__ std::uint32_t ballot(F&& f) {
    return __ballot_sync(kAll, f(lane()));
  }
  template <class T>
  __device__ T broadcast(PerLane<T>& v, int from) {
    return __shfl_sync(kAll, v.value, from);
  }
  template <class T>
  __device__ void match(PerLane<T>& v, PerLane<std::uint32_t>& masks) {
    masks.value = __match_any_sync(kAll, v.value);
  }
  __device__ float sum(PerLane<float>& v) {
    float result = v.value;
#pragma unroll
    for (int bit = 1; bit < kWarp; bit *= 2) result += __shfl_xor_sync(kAll, result, bit);
    return result;
  }
  template <int kN>
  __device__ void sums(PerLane<Row<kN>>& v, PerLane<Row<(kN + kWarp - 1) / kWarp>>& totals) {
    sums_from<kN, 0>(v.value.v, totals.value.v);
  }

 private:
  static constexpr std::uint32_t kAll = ~0u;
  __device__ static int lane() { return static_cast<int>(threadIdx.x) % kWarp; }
  template <int kN, int kFirst>
  __device__ static void sums_from(float* v, float* totals) {
    if constexpr (kFirst < kN) {
      constexpr int kCount = kN - kFirst < kWarp ? kN - kFirst : kWarp;
      totals[kFirst / kWarp] = halve<kCount, 1>(v + kFirst);
      sums_from<kN, kFirst + kWarp>(v, totals);
    }
  }
  template <int kCount, int kBit>
  __device__ static float halve(float* v) {
    if constexpr (kBit == kWarp) {
      return v[0];
    } else {
      const bool odd = (lane() & kBit) != 0;
#pragma unroll
      for (int i = 0; i < (kCount + 1) / 2; ++i) {
        const float sent = half_of(v, kCount, !odd, i);
        v[i] = half_of(v, kCount, odd, i) + __shfl_xor_sync(kAll, sent, kBit);
      }
      return halve<(kCount + 1) / 2, 2 * kBit>(v);
    }
  }
};

template <int kThreads>
class DeviceBlock {
 public:
  static_assert(kThreads % kWarp == 0);
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
  template <class F>
  __device__ void each_warp(F&& f) {
    DeviceWarp warp;
    f(warp);
    __syncthreads();
  }
  __device__ void add(float* p, float value) { atomicAdd(p, value); }
};

// Blocks of a kernel that share a multiprocessor, by which the compiler shares out registers:
// kBlocksAtOnce, where a kernel has an opinion.
template <class Body>
constexpr int blocks_at_once() {
  if constexpr (requires { Body::kBlocksAtOnce; })
    return Body::kBlocksAtOnce;
  else
    return 1;
}

template <class Body>
__global__ void __launch_bounds__(Body::kThreads, blocks_at_once<Body>()) run_blocks(Body body) {
  __shared__ typename Body::Shared shared;
  DeviceBlock<Body::kThreads> block;
  body(block, shared);
}

// Parameters are not copied, as each thread would where it takes an element of an array among them.
template <class F>
__global__ void run_elements(std::size_t count, const __grid_constant__ F f) {
  const std::size_t i = std::size_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (i < count) f(i);
}

#endif

}  // namespace glint::gpu
