// SPDX-License-Identifier: MIT
// What Tracer keeps between calls, and what its forward and backward passes share.
#pragma once

#include <cstdint>
#include <vector>

#include "glint/render/sh_lanes.h"
#include "glint/render/spherical_harmonics.h"
#include "glint/render/surfel_lanes.h"
#include "glint/render/trace.h"
#include "glint/render/trace_bvh.h"

namespace glint {

inline constexpr std::size_t kRaysPerBlock = 64;
inline constexpr std::size_t kSurfelGrain = 512;
inline constexpr std::size_t kSurfelsAhead = 8;  // that memory is asked for in advance
inline constexpr std::size_t kHitsAtOnce = Float8::kLanes;

// Gradient of one surfel.
struct alignas(64) SurfelGradient {
  Vec3f mean, h0, h1;
  Vec3f half_depth;  // sum of dL/dmean t / 2
  Vec2f normal;      // dL/dnormal along h0 and h1; the part along the normal turns nothing
  float opacity, weight;
  ShRow sh;
};
static_assert(sizeof(SurfelGradient) == (kSurfelFloats + 3 * ShRow::kCoefficients) * sizeof(float));

// Gradients of the surfels that a slice of the rays meets. Each slice is summed by one thread in
// the order of its rays, and slices in their order: the same sums for any number of threads.
struct GradientSlice {
  static constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> row_of_slot;  // [N] into `rows`, or kNone
  std::vector<SurfelGradient> rows;
};

struct TraceSaved {
  std::vector<std::uint32_t> slot_of_surfel;  // [N]
  std::vector<TracedSurfel> surfels;          // by slot
  std::vector<ShRow> sh;                      // by slot
  SurfelBvh bvh;
  int updates = 0;
  std::vector<std::vector<std::uint32_t>> blocks;  // slots of the hits of each block of rays
  std::vector<std::uint32_t> counts;               // [rays] hits
  std::vector<GradientSlice> slices;
};

struct RayState {
  Vec3f origin, direction;
  ShBasis basis;
  float transmittance = 1;  // below 0: the ray met what it would not go through
};

inline Vec4f rotation_at(const TraceInput& input, std::size_t surfel) {
  const float* q = &input.rotations[4 * surfel];
  return {q[0], q[1], q[2], q[3]};
}
RayState ray_at(const Rays& rays, int sh_degree, std::size_t i);

// Colours of eight surfels along a ray.
struct HitColors {
  Vec3<Float8> sums, colors;  // before and after sh_color()
};
GLINT_SIMD_INLINE HitColors hit_colors(const ShBasis& basis, const ShRow* const rows[8]) {
  const Vec3<Float8> s = sh_sums(basis, rows);
  return {s, {sh_color(s.x), sh_color(s.y), sh_color(s.z)}};
}

// Surfels and colours lie scattered in memory: asked for before they are needed.
inline void prefetch_hit(const TraceSaved& saved, std::uint32_t slot) {
  __builtin_prefetch(&saved.surfels[slot]);
  for (const auto& color : saved.sh[slot].colors) __builtin_prefetch(color);
}

// The passes of Tracer on the CPU.
void trace_forward(const TraceCall& call, TraceOutput& output, TraceSaved& saved);
void trace_backward(
    const TraceCall& call,
    const TraceOutput& output,
    const TraceOutputGradient& dL_doutput,
    TraceGradient& gradient,
    TraceSaved& saved
);
std::size_t trace_num_hits(const TraceSaved& saved);

}  // namespace glint
