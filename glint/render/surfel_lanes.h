// SPDX-License-Identifier: MIT
// Surfels as rays see them: one a cache line, and eight of them as lanes.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

#include "glint/core/simd.h"
#include "glint/core/vec.h"

namespace glint {

template <class T>
struct SurfelFields {
  Vec3<T> mean, h0, h1;  // h0, h1: scaled tangents
  T opacity;
  T max_rho;  // squared radius in sigma beyond which it does not count; not positive: nowhere
};

struct alignas(64) TracedSurfel {
  SurfelFields<float> fields;
  Vec3f normal;  // unit, either side
  std::uint32_t surfel;
  float unused;

  const float* floats() const { return reinterpret_cast<const float*>(this); }
};
inline constexpr int kSurfelFloats = 16;
static_assert(sizeof(TracedSurfel) == kSurfelFloats * sizeof(float));

// v[i] lane j <-> v[j] lane i.
GLINT_SIMD_INLINE void transpose_lanes(Float8 v[8]) {
  using L = Float8::Lanes;
  L pairs[8], quads[8];
  for (int i = 0; i < 8; i += 2) {
    pairs[i] = __builtin_ia32_unpcklps256(v[i].lanes, v[i + 1].lanes);
    pairs[i + 1] = __builtin_ia32_unpckhps256(v[i].lanes, v[i + 1].lanes);
  }
  for (int i = 0; i < 8; i += 4)
    for (int k = 0; k < 2; ++k) {
      quads[i + 2 * k] = __builtin_ia32_shufps256(pairs[i + k], pairs[i + k + 2], 0x44);
      quads[i + 2 * k + 1] = __builtin_ia32_shufps256(pairs[i + k], pairs[i + k + 2], 0xee);
    }
  for (int i = 0; i < 4; ++i) {
    v[i] = Float8(__builtin_ia32_vperm2f128_ps256(quads[i], quads[i + 4], 0x20));
    v[i + 4] = Float8(__builtin_ia32_vperm2f128_ps256(quads[i], quads[i + 4], 0x31));
  }
}

// Eight rows of 16 floats <-> 16 vectors of one column each.
using RowLanes = Float8[kSurfelFloats];
GLINT_SIMD_INLINE void load_columns(const float* const rows[8], RowLanes& columns) {
  for (int half = 0; half < 2; ++half) {
    for (int i = 0; i < 8; ++i) columns[8 * half + i] = Float8::load(rows[i] + 8 * half);
    transpose_lanes(&columns[8 * half]);
  }
}

struct SurfelLanes {
  SurfelFields<Float8> fields;
  Vec3<Float8> normal;
};
GLINT_SIMD_INLINE SurfelLanes surfel_lanes(const RowLanes& c) {
  return {
      {{c[0], c[1], c[2]}, {c[3], c[4], c[5]}, {c[6], c[7], c[8]}, c[9], c[10]},
      {c[11], c[12], c[13]}};
}

GLINT_SIMD_INLINE unsigned lane_bits(Mask8 mask) {
  return static_cast<unsigned>(__builtin_ia32_movmskps256(reinterpret_cast<Float8::Lanes>(mask.lanes
  )));
}
GLINT_SIMD_INLINE Mask8::Lanes load_integers(const std::uint32_t* p) {
  Mask8::Lanes lanes;
  std::memcpy(&lanes, p, sizeof lanes);
  return lanes;
}
GLINT_SIMD_INLINE void store_integers(Mask8::Lanes lanes, std::uint32_t* p) {
  std::memcpy(p, &lanes, sizeof lanes);
}

// For each set of lanes, its members in order: a permutation that moves them to the front.
struct PackTable {
  using Bytes = char __attribute__((vector_size(16)));
  alignas(16) std::array<std::array<char, 16>, 256> lanes{};
  constexpr PackTable() {
    for (unsigned set = 0; set < 256; ++set)
      for (unsigned lane = 0, n = 0; lane < 8; ++lane)
        if (set >> lane & 1) lanes[set][n++] = static_cast<char>(lane);
  }
  GLINT_SIMD_INLINE Mask8::Lanes order(unsigned set) const {
    Bytes bytes;
    std::memcpy(&bytes, lanes[set].data(), sizeof bytes);
    return __builtin_ia32_pmovsxbd256(bytes);
  }
};
inline constexpr PackTable kPackTable;

template <class T>
GLINT_SIMD_INLINE Vec3<Float8> all_lanes(Vec3<T> v) {
  return {Float8(v.x), Float8(v.y), Float8(v.z)};
}

}  // namespace glint
