// SPDX-License-Identifier: MIT
// Surfels as rays see them, and boxes around them.
#pragma once

#include "glint/core/vec.h"
#include "glint/cuda/block.h"
#include "glint/render/activations.h"
#include "glint/render/blend.h"
#include "glint/render/intersect.h"

namespace glint::gpu {

struct Box {
  Vec3f low, high;
};
GLINT_HD Box empty_box() { return {{1e30f, 1e30f, 1e30f}, {-1e30f, -1e30f, -1e30f}}; }
GLINT_HD Box union_of(const Box& a, const Box& b) {
  return {
      {min_of(a.low.x, b.low.x), min_of(a.low.y, b.low.y), min_of(a.low.z, b.low.z)},
      {max_of(a.high.x, b.high.x), max_of(a.high.y, b.high.y), max_of(a.high.z, b.high.z)}};
}
// Half of the surface; negative for an empty box.
GLINT_HD float half_area(const Box& box) {
  const Vec3f size = box.high - box.low;
  return size.x < 0 ? -1.0f : size.x * size.y + size.y * size.z + size.z * size.x;
}

struct alignas(16) Disc {
  Vec3f mean, h0, h1, normal;
  float opacity;
  float max_rho;  // squared radius in sigma beyond which it does not count; not positive: nowhere
  std::uint32_t surfel;
};
static_assert(sizeof(Disc) == 64);
struct TraceCutoffs {
  float near, max_rho, min_alpha, min_transmittance;
  int max_hits;
};
struct DeviceTraceInput {
  std::size_t count;
  int sh_degree;
  const float *means, *scales, *rotations, *opacities, *sh_dc, *sh_rest;
};

GLINT_HD Disc disc_at(const DeviceTraceInput& input, const TraceCutoffs& cutoffs, std::size_t i) {
  const float *m = input.means + 3 * i, *q = input.rotations + 4 * i;
  const Mat3f r = rotation_matrix(Vec4f{q[0], q[1], q[2], q[3]});
  Disc d;
  d.mean = {m[0], m[1], m[2]};
  d.h0 = input.scales[2 * i] * column(r, 0);
  d.h1 = input.scales[2 * i + 1] * column(r, 1);
  d.normal = column(r, 2);
  d.opacity = input.opacities[i];
  const Vec3f sum = d.mean + d.h0 + d.h1;
  const bool finite = abs_of(sum.x + sum.y + sum.z) < 1e30f;  // false for NaN
  d.max_rho = finite ? max_rho_of(d.opacity, cutoffs.max_rho, cutoffs.min_alpha) : -1.0f;
  d.surfel = static_cast<std::uint32_t>(i);
  return d;
}

// The box of a disc with a margin for rounding; empty where it counts nowhere.
GLINT_HD Box box_of(const Disc& d) {
  Box box = empty_box();
  if (!(d.max_rho > 0)) return box;
  for (int axis = 0; axis < 3; ++axis) {
    const float spread = sqrt_of(d.max_rho * (d.h0[axis] * d.h0[axis] + d.h1[axis] * d.h1[axis]));
    const float half = 1.0001f * spread + 1e-6f * abs_of(d.mean[axis]);
    box.low[axis] = d.mean[axis] - half;
    box.high[axis] = d.mean[axis] + half;
  }
  return box;
}

GLINT_HD PlaneHit<float> meet(const Disc& d, Vec3f origin, Vec3f direction) {
  const RayPlane<float> plane =
      ray_plane(d.h0, d.h1, cross(d.h0, d.h1), d.mean - origin, direction);
  return intersect(plane.zeta, plane.det);
}
GLINT_HD SplatAlpha<float> alpha_of(const Disc& d, const PlaneHit<float>& hit, float max_rho) {
  return splat_alpha(d.opacity, min_of(squared_radius(hit), max_rho));
}

}  // namespace glint::gpu
