// SPDX-License-Identifier: MIT
// The 45 higher SH coefficients of a surfel, [15][3] with the colour fastest, in six vectors: rays
// evaluate them at every hit, so the plain loops of spherical_harmonics.h would dominate trace().
// The last vector starts at 37 and overlaps the one before by three lanes, where bases are zero.
#pragma once

#include "glint/core/simd.h"
#include "glint/core/vec.h"

namespace glint {

struct ShLanes {
  static constexpr int kVectors = 6, kFloats = 8 * kVectors, kCoefficients = 45;
  static constexpr int kOffset[kVectors] = {0, 8, 16, 24, 32, 37};
  static constexpr int kOverlap = 3;
  Float8 v[kVectors];

  static ShLanes zero() {
    const Float8 zero(0.0f);
    return {{zero, zero, zero, zero, zero, zero}};
  }
  static ShLanes load(const float* coefficients) {
    ShLanes lanes;
    for (int i = 0; i < kVectors; ++i) lanes.v[i] = Float8::load(coefficients + kOffset[i]);
    return lanes;
  }
  // The overlapping lanes come from the fifth vector.
  void store(float* coefficients) const {
    v[kVectors - 1].store(coefficients + kOffset[kVectors - 1]);
    for (int i = 0; i + 1 < kVectors; ++i) v[i].store(coefficients + kOffset[i]);
  }
};

// basis[16] of a direction as it multiplies the coefficients, [48] floats.
inline void expand_basis(const float basis[16], float* expanded) {
  for (int i = 0; i < ShLanes::kVectors; ++i)
    for (int lane = 0; lane < 8; ++lane) {
      const bool overlap = i + 1 == ShLanes::kVectors && lane < ShLanes::kOverlap;
      expanded[8 * i + lane] = overlap ? 0.0f : basis[1 + (ShLanes::kOffset[i] + lane) / 3];
    }
}
inline ShLanes load_expanded(const float* expanded) {
  ShLanes lanes;
  for (int i = 0; i < ShLanes::kVectors; ++i) lanes.v[i] = Float8::load(expanded + 8 * i);
  return lanes;
}

// A colour repeated over the lanes: pattern[i % 3] fits vector i.
struct ColorPattern {
  Float8 pattern[3];
};
inline ColorPattern repeat(Vec3f c) {
  return {
      {Float8::Lanes{c.x, c.y, c.z, c.x, c.y, c.z, c.x, c.y},
       Float8::Lanes{c.z, c.x, c.y, c.z, c.x, c.y, c.z, c.x},
       Float8::Lanes{c.y, c.z, c.x, c.y, c.z, c.x, c.y, c.z}}};
}

// sum_k basis_k coefficient_k of each colour, without k = 0.
inline Vec3f sh_dot(const ShLanes& basis, const ShLanes& coefficients) {
  alignas(32) float sums[24];
  for (int i = 0; i < 3; ++i)
    fma_of(basis.v[i + 3], coefficients.v[i + 3], basis.v[i] * coefficients.v[i])
        .store(sums + 8 * i);
  Vec3f sum{};
  for (int i = 0; i < 24; i += 3) sum += Vec3f{sums[i], sums[i + 1], sums[i + 2]};
  return sum;
}

// lanes += color (x) other, the outer product that both vjps of sh_dot need.
inline void add_scaled(ShLanes& lanes, const ColorPattern& color, const ShLanes& other) {
  for (int i = 0; i < ShLanes::kVectors; ++i)
    lanes.v[i] = fma_of(color.pattern[i % 3], other.v[i], lanes.v[i]);
}

// dL/dbasis from its 48 lanes; basis[0] is left alone.
inline void collect_basis(const ShLanes& lanes, float basis[16]) {
  alignas(32) float expanded[ShLanes::kFloats];
  for (int i = 0; i < ShLanes::kVectors; ++i) lanes.v[i].store(expanded + 8 * i);
  for (int i = 0; i < ShLanes::kVectors; ++i)
    for (int lane = i + 1 == ShLanes::kVectors ? ShLanes::kOverlap : 0; lane < 8; ++lane)
      basis[1 + (ShLanes::kOffset[i] + lane) / 3] += expanded[8 * i + lane];
}

}  // namespace glint
