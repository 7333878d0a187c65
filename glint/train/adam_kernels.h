// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "glint/core/kernel.h"
#include "glint/core/real.h"

namespace glint {

inline constexpr int kMaxRates = 8;  // columns of an array with rates of their own

// Adam [Kingma15] on one number: p -= rate m / (sqrt(v) + eps) with bias-corrected moments, the
// corrections folded into the rates and `scale_v`. kOneRate: for all columns.
template <bool kOneRate>
struct AdamKernel {
  static constexpr float kBeta1 = 0.9f, kBeta2 = 0.999f, kEpsilon = 1e-15f;

  float *p, *g, *m, *v;
  float rates[kMaxRates];  // over 1 - beta1^t
  std::size_t columns;
  float scale_v;                           // 1 / (1 - beta2^t)
  const std::uint32_t* is_void = nullptr;  // void_steps.h; null: no

  GLINT_HD void operator()(std::size_t i) const {
    if (is_void != nullptr && *is_void != 0) {
      g[i] = 0;
      return;
    }
    const float rate = kOneRate ? rates[0] : rates[i % columns];
    m[i] = kBeta1 * m[i] + (1 - kBeta1) * g[i];
    v[i] = kBeta2 * v[i] + (1 - kBeta2) * g[i] * g[i];
    p[i] -= rate * m[i] / (sqrt_of(v[i] * scale_v) + kEpsilon);
    g[i] = 0;
  }
};

using AdamKernels = KernelList<AdamKernel<true>, AdamKernel<false>>;

}  // namespace glint
