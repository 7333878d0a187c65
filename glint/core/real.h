// SPDX-License-Identifier: MIT
// What a number type T must offer to the shared maths: float, double (here) and Float8 (simd.h).
// Data-dependent branches are written as select(mask, a, b). No exp of the C library: see exp_fast.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#if defined(__CUDACC__)
#define GLINT_HD __host__ __device__ inline
#else
#define GLINT_HD inline
#endif

namespace glint {

// Comparison results: bool for scalars, a lane mask for Float8.
template <class T>
struct MaskOf {
  using type = bool;
};
template <class T>
using Mask = typename MaskOf<T>::type;

// How many numbers a T holds.
template <class T>
inline constexpr int kLanesOf = 1;

GLINT_HD float select(bool mask, float a, float b) { return mask ? a : b; }
GLINT_HD double select(bool mask, double a, double b) { return mask ? a : b; }
GLINT_HD bool any(bool mask) { return mask; }
GLINT_HD bool all(bool mask) { return mask; }

GLINT_HD float min_of(float a, float b) { return a < b ? a : b; }
GLINT_HD double min_of(double a, double b) { return a < b ? a : b; }
GLINT_HD float max_of(float a, float b) { return a > b ? a : b; }
GLINT_HD double max_of(double a, double b) { return a > b ? a : b; }
GLINT_HD float abs_of(float a) { return fabsf(a); }
GLINT_HD double abs_of(double a) { return fabs(a); }
GLINT_HD float log_of(float a) { return ::logf(a); }
GLINT_HD double log_of(double a) { return ::log(a); }
GLINT_HD float sqrt_of(float a) { return sqrtf(a); }
GLINT_HD double sqrt_of(double a) { return sqrt(a); }
// a * b + c in one rounding, on every backend: forward and backward passes must agree to the bit.
GLINT_HD float fma_of(float a, float b, float c) { return fmaf(a, b, c); }
GLINT_HD double fma_of(double a, double b, double c) { return fma(a, b, c); }

// a where the mask holds, else 0. Cheaper than select() on lanes.
GLINT_HD float keep(bool mask, float a) { return mask ? a : 0.0f; }
GLINT_HD double keep(bool mask, double a) { return mask ? a : 0.0; }

// Building blocks of exp_bounded. Adding kRoundingShift rounds to the nearest integer and leaves it
// in the low bits; times_exp2 adds those bits to the exponent of p.
inline constexpr float kRoundingShift = 12582912.0f;  // 1.5 * 2^23
GLINT_HD float times_exp2(float p, float shifted) {
  std::uint32_t p_bits, shifted_bits;
  memcpy(&p_bits, &p, sizeof p);
  memcpy(&shifted_bits, &shifted, sizeof shifted);
  p_bits += shifted_bits << 23;
  memcpy(&p, &p_bits, sizeof p);
  return p;
}

// e^x for x in [-87, 87]. Splits off 2^k and evaluates a degree-6 polynomial on [-ln2/2, ln2/2]:
// 1 + r + ..., the rest fitted for the least relative error (3e-9, where Taylor's leaves 1e-7).
// Relative error below 1e-7 with rounding. One text for float and Float8.
template <class T>
GLINT_HD T exp_bounded(T x) {
  const T shifted = fma_of(x, T(1.44269504088896341f), T(kRoundingShift));
  const T k = shifted - T(kRoundingShift);
  // Cody-Waite: ln2 in two parts keeps the remainder exact.
  T r = fma_of(k, T(-0.693145751953125f), x);
  r = fma_of(k, T(-1.42860682030941723e-6f), r);
  T p = T(1.38145394e-3f);
  p = fma_of(p, r, T(8.36874545e-3f));
  p = fma_of(p, r, T(4.1668389e-2f));
  p = fma_of(p, r, T(0.166665211f));
  p = fma_of(p, r, T(0.49999994f));
  p = fma_of(p, r, T(1.0f));
  p = fma_of(p, r, T(1.0f));
  return times_exp2(p, shifted);
}
GLINT_HD double exp_bounded(double x) { return exp(x); }
// e^x, x clamped to [-87, 87].
template <class T>
GLINT_HD T exp_fast(T x) {
  return exp_bounded(min_of(max_of(x, T(-87.0f)), T(87.0f)));
}
GLINT_HD double exp_fast(double x) { return exp(x); }

template <class T>
GLINT_HD T square(T a) {
  return a * a;
}

// Lane i of a T is at p[i * stride]: one field of kLanesOf<T> consecutive rows. This one: scalars.
template <class T>
struct StridedLanes {
  GLINT_HD static T load(const float* p, std::ptrdiff_t) { return T(*p); }
  GLINT_HD static void store(float* p, std::ptrdiff_t, T value) { *p = static_cast<float>(value); }
};
template <class T>
GLINT_HD T load_strided(const float* p, std::ptrdiff_t stride) {
  return StridedLanes<T>::load(p, stride);
}
template <class T>
GLINT_HD void store_strided(float* p, std::ptrdiff_t stride, T value) {
  StridedLanes<T>::store(p, stride, value);
}
template <class T>
GLINT_HD void add_strided(float* p, std::ptrdiff_t stride, T value) {
  store_strided(p, stride, load_strided<T>(p, stride) + value);
}

}  // namespace glint
