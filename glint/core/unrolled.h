// SPDX-License-Identifier: MIT
#pragma once

#include "glint/core/real.h"

namespace glint {

// f(0), ..., f(kCount - 1) with constants, so that arrays indexed by them stay in registers.
template <int kCount, class F, int kFirst = 0>
GLINT_HD void unrolled(F&& f) {
  if constexpr (kFirst < kCount) {
    f(kFirst);
    unrolled<kCount, F, kFirst + 1>(static_cast<F&&>(f));
  }
}

}  // namespace glint
