// SPDX-License-Identifier: MIT
// Stable sort of indices by float keys (least significant digit first, 11 bits a pass).
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "glint/core/real.h"

namespace glint {

// Order of unsigned keys = order of floats (negative ones too; NaN is not allowed).
GLINT_HD std::uint32_t sortable_bits(float value) {
  std::uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits ^ ((bits >> 31) != 0 ? 0xffffffffu : 0x80000000u);
}

struct KeyedIndex {
  std::uint32_t key, index;
};

// Sorts `items` by key; `scratch` is resized as needed.
inline void radix_sort(std::vector<KeyedIndex>& items, std::vector<KeyedIndex>& scratch) {
  constexpr int kBits = 11, kPasses = 3;
  constexpr std::uint32_t kMask = (1u << kBits) - 1;
  scratch.resize(items.size());
  std::array<std::array<std::uint32_t, 1u << kBits>, kPasses> counts{};
  for (const KeyedIndex& item : items)
    for (int pass = 0; pass < kPasses; ++pass) ++counts[pass][(item.key >> (pass * kBits)) & kMask];
  for (int pass = 0; pass < kPasses; ++pass) {
    std::uint32_t sum = 0;
    for (std::uint32_t& count : counts[pass]) sum += std::exchange(count, sum);
    for (const KeyedIndex& item : items)
      scratch[counts[pass][(item.key >> (pass * kBits)) & kMask]++] = item;
    items.swap(scratch);
  }
}

}  // namespace glint
