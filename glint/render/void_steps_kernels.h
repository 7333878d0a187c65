// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "glint/core/kernel.h"

namespace glint {

// Of words[0], whether the step is void, words[1], how many steps were, and words[2], the last
// one's iteration.
struct CountVoidStep {
  std::uint32_t* words;
  std::uint32_t iteration;
  GLINT_HD void operator()(std::size_t) const {
    if (words[0] == 0) return;
    ++words[1];
    words[2] = iteration;
    words[0] = 0;
  }
};

using VoidStepsKernels = KernelList<CountVoidStep>;

}  // namespace glint
