// SPDX-License-Identifier: MIT
// Float16: sixteen float lanes with the interface of real.h. Only for files that are compiled for
// AVX-512 (glint/CMakeLists.txt); never reachable from others.
#pragma once

#include <immintrin.h>

#include "glint/core/simd.h"

namespace glint {

struct Mask16 {
  __mmask16 lanes;
};

struct Float16 {
  using Lanes = float __attribute__((vector_size(64)));
  Lanes lanes;

  Float16() = default;
  GLINT_SIMD_INLINE Float16(Lanes value) : lanes(value) {}
  GLINT_SIMD_INLINE Float16(float v) : lanes(_mm512_set1_ps(v)) {}

  static GLINT_SIMD_INLINE Float16 load(const float* p) { return Lanes(_mm512_loadu_ps(p)); }
  GLINT_SIMD_INLINE void store(float* p) const { _mm512_storeu_ps(p, lanes); }
  GLINT_SIMD_INLINE Float8 low() const { return Float8::Lanes(_mm512_castps512_ps256(lanes)); }
  GLINT_SIMD_INLINE Float8 high() const { return Float8::Lanes(_mm512_extractf32x8_ps(lanes, 1)); }
};

template <>
struct MaskOf<Float16> {
  using type = Mask16;
};
template <>
inline constexpr int kLanesOf<Float16> = 16;

GLINT_SIMD_INLINE Float16 operator+(Float16 a, Float16 b) { return a.lanes + b.lanes; }
GLINT_SIMD_INLINE Float16 operator-(Float16 a, Float16 b) { return a.lanes - b.lanes; }
GLINT_SIMD_INLINE Float16 operator*(Float16 a, Float16 b) { return a.lanes * b.lanes; }
GLINT_SIMD_INLINE Float16 operator/(Float16 a, Float16 b) { return a.lanes / b.lanes; }
GLINT_SIMD_INLINE Float16 operator-(Float16 a) { return -a.lanes; }
GLINT_SIMD_INLINE Float16& operator+=(Float16& a, Float16 b) { return a = a + b; }

template <int kOrder>
GLINT_SIMD_INLINE Mask16 compare(Float16 a, Float16 b) {
  return {_mm512_cmp_ps_mask(a.lanes, b.lanes, kOrder)};
}
GLINT_SIMD_INLINE Mask16 operator<(Float16 a, Float16 b) { return compare<_CMP_LT_OS>(a, b); }
GLINT_SIMD_INLINE Mask16 operator<=(Float16 a, Float16 b) { return compare<_CMP_LE_OS>(a, b); }
GLINT_SIMD_INLINE Mask16 operator>(Float16 a, Float16 b) { return compare<_CMP_GT_OS>(a, b); }
GLINT_SIMD_INLINE Mask16 operator>=(Float16 a, Float16 b) { return compare<_CMP_GE_OS>(a, b); }
GLINT_SIMD_INLINE Mask16 operator==(Float16 a, Float16 b) { return compare<_CMP_EQ_OQ>(a, b); }
GLINT_SIMD_INLINE Mask16 operator&(Mask16 a, Mask16 b) { return {_kand_mask16(a.lanes, b.lanes)}; }
GLINT_SIMD_INLINE Mask16 operator|(Mask16 a, Mask16 b) { return {_kor_mask16(a.lanes, b.lanes)}; }
GLINT_SIMD_INLINE Mask16 operator!(Mask16 a) { return {_knot_mask16(a.lanes)}; }

GLINT_SIMD_INLINE Float16 select(Mask16 mask, Float16 a, Float16 b) {
  return Float16::Lanes(_mm512_mask_blend_ps(mask.lanes, b.lanes, a.lanes));
}
GLINT_SIMD_INLINE Float16 keep(Mask16 mask, Float16 a) {
  return Float16::Lanes(_mm512_maskz_mov_ps(mask.lanes, a.lanes));
}
GLINT_SIMD_INLINE bool any(Mask16 mask) { return mask.lanes != 0; }
GLINT_SIMD_INLINE bool all(Mask16 mask) { return mask.lanes == 0xffff; }

GLINT_SIMD_INLINE Float16 min_of(Float16 a, Float16 b) {
  return Float16::Lanes(_mm512_min_ps(a.lanes, b.lanes));
}
GLINT_SIMD_INLINE Float16 max_of(Float16 a, Float16 b) {
  return Float16::Lanes(_mm512_max_ps(a.lanes, b.lanes));
}
GLINT_SIMD_INLINE Float16 abs_of(Float16 a) { return Float16::Lanes(_mm512_abs_ps(a.lanes)); }
GLINT_SIMD_INLINE Float16 sqrt_of(Float16 a) { return Float16::Lanes(_mm512_sqrt_ps(a.lanes)); }
GLINT_SIMD_INLINE Float16 fma_of(Float16 a, Float16 b, Float16 c) {
  return Float16::Lanes(_mm512_fmadd_ps(a.lanes, b.lanes, c.lanes));
}
GLINT_SIMD_INLINE Float16 times_exp2(Float16 p, Float16 shifted) {
  const __m512i exponent = _mm512_slli_epi32(_mm512_castps_si512(shifted.lanes), 23);
  return Float16::Lanes(_mm512_castsi512_ps(_mm512_add_epi32(_mm512_castps_si512(p.lanes), exponent)
  ));
}

GLINT_SIMD_INLINE Float8 sum_of_halves(Float16 v) { return v.low() + v.high(); }

template <>
GLINT_SIMD_INLINE Float16 load_lanes<Float16>(const float* p) {
  return Float16::load(p);
}
GLINT_SIMD_INLINE void store_lanes(float* p, Float16 v) { v.store(p); }

}  // namespace glint
