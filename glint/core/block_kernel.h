// SPDX-License-Identifier: MIT
// Kernels of blocks of threads that share memory, on either device. Written as glint/cuda/block.h
// says, of whose Block they use `index`, PerThread and each(): on the CPU blocks are a parallel
// loop, and a block's threads run one after the other. Listed like other kernels (kernel.h).
#pragma once

#include <memory>
#include <vector>

#include "glint/core/kernel.h"

namespace glint {

template <class Kernel>
struct BlocksOnGpu {
  static inline void (*run)(std::size_t blocks, const Kernel&) = nullptr;
};

// A block on the CPU.
template <int kThreads>
class SerialBlock {
 public:
  template <class T>
  struct PerThread {
    std::vector<T> values = std::vector<T>(kThreads);
    T& operator[](int thread) { return values[static_cast<std::size_t>(thread)]; }
  };
  int index = 0;

  template <class F>
  void each(F&& f) {
    for (int thread = 0; thread < kThreads; ++thread) f(thread);
  }
};

// kernel(block, shared) for blocks [0, count).
template <class Kernel>
void run_block_kernel(std::size_t count, const Kernel& kernel) {
  if (!on_gpu()) {
    const TracedKernel traced(typeid(Kernel));
    return parallel_for(count, 1, [&](std::size_t i) {
      SerialBlock<Kernel::kThreads> block;
      block.index = static_cast<int>(i);
      const auto shared = std::make_unique<typename Kernel::Shared>();
      kernel(block, *shared);
    });
  }
  if (BlocksOnGpu<Kernel>::run == nullptr) detail::throw_no_gpu_kernel(typeid(Kernel).name());
  BlocksOnGpu<Kernel>::run(count, kernel);
}

}  // namespace glint
