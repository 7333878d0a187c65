// SPDX-License-Identifier: MIT
// The spherical harmonics of a surfel as rays read them: three cache lines, one a colour, so that a
// colour is two vector products with the basis.
#pragma once

#include "glint/core/simd.h"
#include "glint/core/vec.h"

namespace glint {

struct alignas(64) ShRow {
  static constexpr int kCoefficients = 16;
  float colors[3][kCoefficients];

  // dc [3], rest [15][3], as clouds store them.
  static ShRow pack(const float* dc, const float* rest) {
    ShRow row;
    for (int c = 0; c < 3; ++c) {
      row.colors[c][0] = dc[c];
      for (int k = 1; k < kCoefficients; ++k) row.colors[c][k] = rest[3 * (k - 1) + c];
    }
    return row;
  }
  void unpack(float* dc, float* rest) const {
    for (int c = 0; c < 3; ++c) {
      dc[c] = colors[c][0];
      for (int k = 1; k < kCoefficients; ++k) rest[3 * (k - 1) + c] = colors[c][k];
    }
  }
};

// basis[16] of a direction, or its gradient.
struct ShBasis {
  Float8 low, high;
};
GLINT_SIMD_INLINE ShBasis load_basis(const float* basis) {
  return {Float8::load(basis), Float8::load(basis + 8)};
}

// sum_k basis_k coefficient_k of each colour, for eight surfels seen along one ray.
GLINT_SIMD_INLINE Vec3<Float8> sh_sums(const ShBasis& basis, const ShRow* const rows[8]) {
  Vec3<Float8> sums;
  for (int c = 0; c < 3; ++c) {
    Float8 products[8];
    for (int i = 0; i < 8; ++i)
      products[i] = fma_of(
          basis.high,
          Float8::load(rows[i]->colors[c] + 8),
          basis.low * Float8::load(rows[i]->colors[c])
      );
    sums[c] = lane_sums(products);
  }
  return sums;
}

// The two products that sh_sums' vjp needs, for one surfel: with dL/dsum of its colours.
GLINT_SIMD_INLINE void add_basis_vjp(const ShRow& row, Vec3f dL_dsum, ShBasis& dL_dbasis) {
  for (int c = 0; c < 3; ++c) {
    const Float8 g(dL_dsum[c]);
    dL_dbasis.low = fma_of(g, Float8::load(row.colors[c]), dL_dbasis.low);
    dL_dbasis.high = fma_of(g, Float8::load(row.colors[c] + 8), dL_dbasis.high);
  }
}
GLINT_SIMD_INLINE void add_coefficients_vjp(const ShBasis& basis, Vec3f dL_dsum, ShRow& dL_drow) {
  for (int c = 0; c < 3; ++c) {
    const Float8 g(dL_dsum[c]);
    float* to = dL_drow.colors[c];
    fma_of(g, basis.low, Float8::load(to)).store(to);
    fma_of(g, basis.high, Float8::load(to + 8)).store(to + 8);
  }
}

}  // namespace glint
