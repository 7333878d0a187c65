// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace glint::test {

// How often a word stands in a text.
inline std::size_t count_of(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    ++count;
  return count;
}

}  // namespace glint::test
