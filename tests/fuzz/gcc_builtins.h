// SPDX-License-Identifier: MIT
// GCC's vector builtins for Clang, which fuzzes: read in front of every file of the preset fuzz.
// Slow loops are good enough there.
#pragma once

#if defined(__clang__) && defined(__cplusplus)

template <class V, class M>
inline V __builtin_shuffle(V values, M order) {
  constexpr int kLanes = sizeof(V) / sizeof(values[0]);
  V result = values;
  for (int i = 0; i < kLanes; ++i) result[i] = values[order[i] & (kLanes - 1)];
  return result;
}

template <class V, class M>
inline V __builtin_shuffle(V a, V b, M order) {
  constexpr int kLanes = sizeof(V) / sizeof(a[0]);
  V result = a;
  for (int i = 0; i < kLanes; ++i) {
    const int from = order[i] & (2 * kLanes - 1);
    result[i] = from < kLanes ? a[from] : b[from - kLanes];
  }
  return result;
}

template <class V>
inline V __builtin_ia32_unpcklps256(V a, V b) {
  return __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
}

template <class V>
inline V __builtin_ia32_unpckhps256(V a, V b) {
  return __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
}

// Eight of sixteen signed bytes as integers.
template <class V>
inline int __attribute__((vector_size(32))) __builtin_ia32_pmovsxbd256(V bytes) {
  int __attribute__((vector_size(32))) result = {};
  for (int i = 0; i < 8; ++i) result[i] = static_cast<signed char>(bytes[i]);
  return result;
}

#endif
