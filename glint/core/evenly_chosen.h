// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace glint {

// `count` of the numbers below `all`, at equal distances; all of them where there are no more.
inline std::vector<std::size_t> evenly_chosen(std::size_t count, std::size_t all) {
  count = std::min(count, all);
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < count; ++i) chosen.push_back((2 * i + 1) * all / (2 * count));
  return chosen;
}

}  // namespace glint
