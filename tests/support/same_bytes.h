// SPDX-License-Identifier: MIT
// Images, and arrays, bit for bit: NaN equals itself, 0 and -0 differ.
#pragma once

#include <cstring>

#include "glint/core/image.h"

namespace glint::test {

template <class Range>
bool same_bytes(const Range& a, const Range& b) {
  return a.size() == b.size() &&
         (a.size() == 0 || std::memcmp(a.data(), b.data(), a.size() * sizeof(*a.data())) == 0);
}
template <class T>
bool same_bytes(const BasicImage<T>& a, const BasicImage<T>& b) {
  return a.size() == b.size() && a.channels() == b.channels() && same_bytes(a.values(), b.values());
}

}  // namespace glint::test
