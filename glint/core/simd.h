// SPDX-License-Identifier: MIT
// Float8: eight float lanes with the interface of real.h, on GCC's vector extension (AVX2 code with
// -march=x86-64-v3). Host only: never reachable from a .cu file.
#pragma once

#include "glint/core/real.h"

namespace glint {

#define GLINT_SIMD_INLINE inline __attribute__((always_inline))

struct Mask8 {
  using Lanes = std::int32_t __attribute__((vector_size(32)));
  Lanes lanes;
};

struct Float8 {
  using Lanes = float __attribute__((vector_size(32)));
  static constexpr int kLanes = 8;
  Lanes lanes;

  Float8() = default;
  GLINT_SIMD_INLINE Float8(Lanes value) : lanes(value) {}
  GLINT_SIMD_INLINE Float8(float v) : lanes(Lanes{v, v, v, v, v, v, v, v}) {}

  static GLINT_SIMD_INLINE Float8 load(const float* p) {
    Float8 result;
    std::memcpy(&result.lanes, p, sizeof(Lanes));
    return result;
  }
  GLINT_SIMD_INLINE void store(float* p) const { std::memcpy(p, &lanes, sizeof(Lanes)); }
  GLINT_SIMD_INLINE float operator[](int i) const { return lanes[i]; }
};

template <>
struct MaskOf<Float8> {
  using type = Mask8;
};

// Lane indices 0..7, and a plain 0 for scalars.
template <class T>
GLINT_SIMD_INLINE T lane_indices() {
  return T(0);
}
template <>
GLINT_SIMD_INLINE Float8 lane_indices<Float8>() {
  return Float8::Lanes{0, 1, 2, 3, 4, 5, 6, 7};
}

GLINT_SIMD_INLINE Float8 operator+(Float8 a, Float8 b) { return a.lanes + b.lanes; }
GLINT_SIMD_INLINE Float8 operator-(Float8 a, Float8 b) { return a.lanes - b.lanes; }
GLINT_SIMD_INLINE Float8 operator*(Float8 a, Float8 b) { return a.lanes * b.lanes; }
GLINT_SIMD_INLINE Float8 operator/(Float8 a, Float8 b) { return a.lanes / b.lanes; }
GLINT_SIMD_INLINE Float8 operator-(Float8 a) { return -a.lanes; }
GLINT_SIMD_INLINE Float8& operator+=(Float8& a, Float8 b) { return a = a + b; }

GLINT_SIMD_INLINE Mask8 operator<(Float8 a, Float8 b) { return {a.lanes < b.lanes}; }
GLINT_SIMD_INLINE Mask8 operator<=(Float8 a, Float8 b) { return {a.lanes <= b.lanes}; }
GLINT_SIMD_INLINE Mask8 operator>(Float8 a, Float8 b) { return {a.lanes > b.lanes}; }
GLINT_SIMD_INLINE Mask8 operator>=(Float8 a, Float8 b) { return {a.lanes >= b.lanes}; }
GLINT_SIMD_INLINE Mask8 operator==(Float8 a, Float8 b) { return {a.lanes == b.lanes}; }
GLINT_SIMD_INLINE Mask8 operator&(Mask8 a, Mask8 b) { return {a.lanes & b.lanes}; }
GLINT_SIMD_INLINE Mask8 operator|(Mask8 a, Mask8 b) { return {a.lanes | b.lanes}; }
GLINT_SIMD_INLINE Mask8 operator!(Mask8 a) { return {~a.lanes}; }

GLINT_SIMD_INLINE Float8 select(Mask8 mask, Float8 a, Float8 b) {
  return __builtin_ia32_blendvps256(b.lanes, a.lanes, reinterpret_cast<Float8::Lanes>(mask.lanes));
}
GLINT_SIMD_INLINE Float8 keep(Mask8 mask, Float8 a) {
  return reinterpret_cast<Float8::Lanes>(reinterpret_cast<Mask8::Lanes>(a.lanes) & mask.lanes);
}
GLINT_SIMD_INLINE bool any(Mask8 mask) {
  return __builtin_ia32_movmskps256(reinterpret_cast<Float8::Lanes>(mask.lanes)) != 0;
}
GLINT_SIMD_INLINE bool all(Mask8 mask) {
  return __builtin_ia32_movmskps256(reinterpret_cast<Float8::Lanes>(mask.lanes)) == 0xff;
}

GLINT_SIMD_INLINE Float8 min_of(Float8 a, Float8 b) {
  return __builtin_ia32_minps256(a.lanes, b.lanes);
}
GLINT_SIMD_INLINE Float8 max_of(Float8 a, Float8 b) {
  return __builtin_ia32_maxps256(a.lanes, b.lanes);
}
GLINT_SIMD_INLINE Float8 abs_of(Float8 a) {
  return reinterpret_cast<Float8::Lanes>(reinterpret_cast<Mask8::Lanes>(a.lanes) & 0x7fffffff);
}
GLINT_SIMD_INLINE Float8 sqrt_of(Float8 a) { return __builtin_ia32_sqrtps256(a.lanes); }
GLINT_SIMD_INLINE Float8 fma_of(Float8 a, Float8 b, Float8 c) {
  return __builtin_ia32_vfmaddps256(a.lanes, b.lanes, c.lanes);
}
GLINT_SIMD_INLINE Float8 times_exp2(Float8 p, Float8 shifted) {
  return reinterpret_cast<Float8::Lanes>(
      reinterpret_cast<Mask8::Lanes>(p.lanes) +
      (reinterpret_cast<Mask8::Lanes>(shifted.lanes) << 23)
  );
}

// Lane sums of eight vectors as one vector: sums[i] = sum of v[i]'s lanes. Seven adds a halving
// step instead of eight separate reductions.
GLINT_SIMD_INLINE Float8 lane_sums(const Float8 v[8]) {
  using L = Float8::Lanes;
  const L a = __builtin_ia32_haddps256(v[0].lanes, v[1].lanes);
  const L b = __builtin_ia32_haddps256(v[2].lanes, v[3].lanes);
  const L c = __builtin_ia32_haddps256(v[4].lanes, v[5].lanes);
  const L d = __builtin_ia32_haddps256(v[6].lanes, v[7].lanes);
  const L ab = __builtin_ia32_haddps256(a, b);  // low half: lanes 0-3, high half: lanes 4-7
  const L cd = __builtin_ia32_haddps256(c, d);
  return __builtin_shuffle(ab, cd, Mask8::Lanes{0, 1, 2, 3, 8, 9, 10, 11}) +
         __builtin_shuffle(ab, cd, Mask8::Lanes{4, 5, 6, 7, 12, 13, 14, 15});
}
GLINT_SIMD_INLINE float lane_sum(Float8 v) {
  const Float8 s = v + Float8(__builtin_shuffle(v.lanes, Mask8::Lanes{4, 5, 6, 7, 0, 1, 2, 3}));
  return (s[0] + s[1]) + (s[2] + s[3]);
}
GLINT_SIMD_INLINE float lane_sum(float v) { return v; }

// Loads and stores of as many floats as T holds.
template <>
inline constexpr int kLanesOf<Float8> = 8;
template <class T>
GLINT_SIMD_INLINE T load_lanes(const float* p) {
  return *p;
}
template <>
GLINT_SIMD_INLINE Float8 load_lanes<Float8>(const float* p) {
  return Float8::load(p);
}
GLINT_SIMD_INLINE void store_lanes(float* p, float v) { *p = v; }
GLINT_SIMD_INLINE void store_lanes(float* p, Float8 v) { v.store(p); }
template <>
struct StridedLanes<Float8> {
  static GLINT_SIMD_INLINE Float8 load(const float* p, std::ptrdiff_t stride) {
    return Float8::Lanes{
        p[0],
        p[stride],
        p[2 * stride],
        p[3 * stride],
        p[4 * stride],
        p[5 * stride],
        p[6 * stride],
        p[7 * stride]};
  }
  static GLINT_SIMD_INLINE void store(float* p, std::ptrdiff_t stride, Float8 value) {
    for (int i = 0; i < 8; ++i) p[i * stride] = value[i];
  }
};

}  // namespace glint
