// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "glint/core/real.h"

namespace glint {

// The first of `count` ascending keys that is not below `key`; `count`: all are.
template <class Key>
GLINT_HD std::size_t first_at_least(const Key* sorted, std::size_t count, Key key) {
  std::size_t low = 0, high = count;
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    if (sorted[middle] < key)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

}  // namespace glint
