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

// A borrowed array of sums, in steps of 2^-32. A term is held within 2^20. A sum is a number within
// 2^29, that of 2^9 of the largest terms; one beyond, up to 2^11 of them, is NaN, and so is one
// that has a term that is NaN and others within 2^29, in whatever order they come.
struct FixedSums {
  std::int64_t* sums = nullptr;
  static constexpr double kScale = 4294967296.0, kLargest = 1048576.0;
  static constexpr std::int64_t kLargestSum = std::int64_t{1} << 61;
  // From here no sum of other terms leads back to those that are numbers.
  static constexpr std::int64_t kNan = -2 * kLargestSum;

  GLINT_HD void add(std::size_t i, double term) const {
    if (term != term) return set_nan(i);
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
    const std::int64_t sum = sums[i];
    sums[i] = 0;
    const bool is_number = -kLargestSum <= sum && sum <= kLargestSum;
    return is_number ? static_cast<double>(sum) / kScale : static_cast<double>(NAN);
  }

 private:
  GLINT_HD void set_nan(std::size_t i) const {
#if defined(__CUDA_ARCH__)
    atomicExch(
        reinterpret_cast<unsigned long long*>(sums + i), static_cast<unsigned long long>(kNan)
    );
#else
    std::atomic_ref<std::int64_t>(sums[i]).store(kNan, std::memory_order_relaxed);
#endif
  }
};

}  // namespace glint
