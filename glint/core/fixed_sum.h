// SPDX-License-Identifier: MIT
// Sums that many threads add to in any order and that are yet the same to the bit: integers, since
// their addition is associative. For gradients that scatter to places which no thread owns.
#pragma once

#include <atomic>
#include <cstdint>

#include "glint/core/arrays.h"
#include "glint/core/real.h"

namespace glint {

using FixedArray = Array<std::int64_t>;

// A borrowed array of sums, in steps of 2^-32. A term is held within 2^20, so a sum of 2^11 of the
// largest does not overflow.
struct FixedSums {
  std::int64_t* sums = nullptr;
  static constexpr double kScale = 4294967296.0, kLargest = 1048576.0;

  GLINT_HD void add(std::size_t i, double term) const {
    const double held = min_of(max_of(term, -kLargest), kLargest);
    const auto steps = static_cast<std::int64_t>(held * kScale);
#if defined(__CUDA_ARCH__)
    atomicAdd(
        reinterpret_cast<unsigned long long*>(sums + i), static_cast<unsigned long long>(steps)
    );
#else
    std::atomic_ref<std::int64_t>(sums[i]).fetch_add(steps, std::memory_order_relaxed);
#endif
  }
  // The sum, which starts again from zero.
  GLINT_HD double take(std::size_t i) const {
    const double sum = static_cast<double>(sums[i]) / kScale;
    sums[i] = 0;
    return sum;
  }
};

}  // namespace glint
