// SPDX-License-Identifier: MIT
// Rows of arrays by their numbers.
#pragma once

#include <cstdint>

#include "glint/core/kernel.h"

namespace glint {

struct GatherRows {
  const float* from;          // [N][width]
  const std::uint32_t* rows;  // [M]
  std::size_t width;
  float* to;  // [M][width]
  GLINT_HD void operator()(std::size_t i) const {
    to[i] = from[rows[i / width] * width + i % width];
  }
};

using RowKernels = KernelList<GatherRows>;

}  // namespace glint
