// SPDX-License-Identifier: MIT
// The kernels of run_kernel, sum_kernel (glint/core/kernel.h) and run_block_kernel (block_kernel.h)
// on a GPU: those that the headers list which have them (*_kernels.h).
#pragma once

#include <vector>

#include "glint/core/block_kernel.h"
#include "glint/core/kernel.h"
#include "glint/cuda/block.h"
#include "kernel_lists.h"  // made by the build

namespace glint::gpu {

// Sums over runs of kThreads pixels, one a block, by halves.
template <class Kernel>
struct SumRuns {
  static constexpr int kThreads = 256;
  using Sum = SumOf<Kernel>;
  struct Shared {
    alignas(alignof(Sum)) unsigned char bytes[kThreads * sizeof(Sum)];
  };
  Kernel kernel;
  ImageSize size;
  Sum* partial;

  template <class Block>
  GLINT_HD void operator()(Block& block, Shared& shared) const {
    Sum* sums = reinterpret_cast<Sum*>(shared.bytes);
    block.each([&](int thread) {
      const auto i =
          static_cast<std::size_t>(block.index) * kThreads + static_cast<std::size_t>(thread);
      sums[thread] = i < size.num_pixels() ? at(i) : Sum{};
    });
    for (int half = kThreads / 2; half > 0; half /= 2)
      block.each([&](int thread) {
        if (thread < half) sums[thread] += sums[thread + half];
      });
    block.each([&](int thread) {
      if (thread == 0) partial[block.index] = sums[0];
    });
  }

 private:
  GLINT_HD Sum at(std::size_t i) const {
    const auto width = static_cast<std::size_t>(size.width);
    return kernel(static_cast<int>(i % width), static_cast<int>(i / width));
  }
};

// Of the process: one device at a time.
template <class Exec>
Exec& executor() {
  static Exec exec;
  return exec;
}

template <class Exec, class Kernel>
void run_on(std::size_t count, const Kernel& kernel) {
  executor<Exec>().for_each(count, kernel);
}

// One sum of many, in their order by strides, by one block.
template <class Sum>
struct UniteSums {
  static constexpr int kThreads = 256;
  struct Shared {
    alignas(alignof(Sum)) unsigned char bytes[kThreads * sizeof(Sum)];
  };
  const Sum* partial;
  std::size_t count;
  Sum* out;

  template <class Block>
  GLINT_HD void operator()(Block& block, Shared& shared) const {
    Sum* sums = reinterpret_cast<Sum*>(shared.bytes);
    block.each([&](int thread) {
      Sum sum{};
      for (std::size_t i = static_cast<std::size_t>(thread); i < count; i += kThreads)
        sum += partial[i];
      sums[thread] = sum;
    });
    for (int half = kThreads / 2; half > 0; half /= 2)
      block.each([&](int thread) {
        if (thread < half) sums[thread] += sums[thread + half];
      });
    block.each([&](int thread) {
      if (thread == 0) *out = sums[0];
    });
  }
};

template <class Exec, class Kernel>
void sum_on(ImageSize size, const Kernel& kernel, SumOf<Kernel>* out) {
  using Sum = SumOf<Kernel>;
  static typename Exec::template Buffer<Sum> partial;
  const std::size_t threads = SumRuns<Kernel>::kThreads;
  const std::size_t blocks = (size.num_pixels() + threads - 1) / threads;
  partial.resize(blocks);
  executor<Exec>().launch(blocks, SumRuns<Kernel>{kernel, size, partial.data()});
  if (out != nullptr) executor<Exec>().launch(1, UniteSums<Sum>{partial.data(), blocks, out});
}

template <class Exec, class Kernel>
void run_blocks_on(std::size_t blocks, const Kernel& kernel) {
  executor<Exec>().launch(blocks, kernel);
}

// Gives a kernel of whichever kind its place on Exec.
template <class Exec, class Kernel>
void offer() {
  if constexpr (requires { typename Kernel::Shared; })
    BlocksOnGpu<Kernel>::run = run_blocks_on<Exec, Kernel>;
  else if constexpr (requires(const Kernel& kernel) { kernel(0, 0); })
    SumOnGpu<Kernel>::run = sum_on<Exec, Kernel>;
  else
    OnGpu<Kernel>::run = run_on<Exec, Kernel>;
}
template <class Exec, class... Kernels>
void offer_all(KernelList<Kernels...>) {
  (offer<Exec, Kernels>(), ...);
}
template <class Exec, class... Lists>
void offer_lists(KernelList<Lists...>) {
  (offer_all<Exec>(Lists{}), ...);
}

}  // namespace glint::gpu
