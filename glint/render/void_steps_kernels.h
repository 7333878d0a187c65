// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "glint/core/kernel.h"

namespace glint {

// Of words[0], whether the step is void, and words[1], how many steps were.
struct CountVoidStep {
  std::uint32_t* words;
  GLINT_HD void operator()(std::size_t) const {
    words[1] += words[0];
    words[0] = 0;
  }
};

using VoidStepsKernels = KernelList<CountVoidStep>;

}  // namespace glint
