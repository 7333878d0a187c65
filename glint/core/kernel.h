// SPDX-License-Identifier: MIT
// Loops whose bodies run on either device. A kernel is a struct of numbers and pointers with
//   GLINT_HD void operator()(std::size_t i) const;          run_kernel
//   GLINT_HD Sum operator()(int x, int y) const;            sum_kernel; Sum: a number or +=
// On the CPU it is a parallel loop. On the GPU its header, a *_kernels.h in glint/ or baselines/,
// says so in the list at its end: x_kernels.h has XKernels. The build joins the lists for
// glint/cuda, which fills the pointers below: so the layers under it know nothing of it.
#pragma once

#include <cstring>
#include <type_traits>
#include <typeinfo>
#include <vector>

#include "glint/core/arrays.h"
#include "glint/core/image.h"
#include "glint/core/kernel_trace.h"
#include "glint/core/parallel.h"

namespace glint {

template <class... Kernels>
struct KernelList {};

template <class Kernel>
struct OnGpu {
  static inline void (*run)(std::size_t count, const Kernel&) = nullptr;
};
template <class Kernel>
using SumOf = decltype(std::declval<const Kernel&>()(0, 0));
template <class Kernel>
struct SumOnGpu {
  // `sum`: on the device; null: nobody asks for it.
  static inline void (*run)(ImageSize, const Kernel&, SumOf<Kernel>* sum) = nullptr;
};

namespace detail {
[[noreturn]] void throw_no_gpu_kernel(const char* name);
}

// kernel(i) for i in [0, count), `grain` at a time on a thread.
template <class Kernel>
void run_kernel(std::size_t count, std::size_t grain, const Kernel& kernel) {
  if (!on_gpu()) {
    const TracedKernel traced(typeid(Kernel));
    return parallel_for_blocks(count, grain, [&](std::size_t begin, std::size_t end) {
      const Kernel local = kernel;  // its numbers in registers, whatever the kernel writes
      for (std::size_t i = begin; i < end; ++i) local(i);
    });
  }
  if (OnGpu<Kernel>::run == nullptr) detail::throw_no_gpu_kernel(typeid(Kernel).name());
  OnGpu<Kernel>::run(count, kernel);
}

// Sum of term(x, y) over all pixels: along rows, then over rows, so that the number of threads does
// not matter. Terms may write to places of their own pixel.
template <class F>
auto sum_over_pixels(ImageSize size, F&& term) {
  using Sum = decltype(term(0, 0));
  constexpr std::size_t kRowGrain = 8;
  std::vector<Sum> rows(size.height);
  parallel_for(size.height, kRowGrain, [&](std::size_t row) {
    Sum sum{};
    for (int x = 0; x < size.width; ++x) sum += term(x, static_cast<int>(row));
    rows[row] = sum;
  });
  Sum total{};
  for (const Sum& row : rows) total += row;
  return total;
}

namespace detail {
template <class Kernel>
void sum_on_gpu(ImageSize size, const Kernel& kernel, SumOf<Kernel>* sum) {
  if (SumOnGpu<Kernel>::run == nullptr) throw_no_gpu_kernel(typeid(Kernel).name());
  SumOnGpu<Kernel>::run(size, kernel, sum);
}
}  // namespace detail

// What a silent step knows of a sum: numbers that are none.
template <class Sum>
Sum unknown() {
  static_assert(std::is_trivially_copyable_v<Sum>);
  Sum sum;
  std::memset(static_cast<void*>(&sum), 0xff, sizeof sum);
  return sum;
}

// The same for a kernel, on either device; `sum` [1] is where other kernels read it. On the GPU the
// order of the sum is fixed, too, and another.
template <class Kernel>
void sum_kernel_to(ImageSize size, const Kernel& kernel, Array<SumOf<Kernel>>& sum) {
  sum.resize(1);
  if (on_gpu()) return detail::sum_on_gpu(size, kernel, sum.device_for_overwriting());
  const TracedKernel traced(typeid(Kernel));
  sum[0] = sum_over_pixels(size, kernel);
}

// The same for the host, which waits for the GPU. Sums that are only told: in a silent step they
// are not known (NaN), and nothing that is computed may depend on them.
template <class Kernel>
SumOf<Kernel> sum_kernel(ImageSize size, const Kernel& kernel) {
  if (!on_gpu()) {
    const TracedKernel traced(typeid(Kernel));
    return sum_over_pixels(size, kernel);
  }
  if (SilentStep::now()) {
    detail::sum_on_gpu(size, kernel, nullptr);
    return unknown<SumOf<Kernel>>();
  }
  Array<SumOf<Kernel>> sum;
  sum_kernel_to(size, kernel, sum);
  return sum[0];
}

// The element of an array [1] that is only told: NaN in a silent step.
template <class Sum>
Sum told(const Array<Sum>& sum) {
  return SilentStep::now() ? unknown<Sum>() : sum[0];
}

}  // namespace glint
