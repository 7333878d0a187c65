// SPDX-License-Identifier: MIT
// An independent tracer to check trace() against: double precision, every surfel for every ray, no
// tree. Planes are met by their normal (t = n.(mu - o) / n.d), not by the plane map of intersect.h,
// and spherical harmonics are evaluated from a table of monomials. Differentiate it by central
// differences (gradcheck.h).
#pragma once

#include <limits>
#include <vector>

#include "glint/render/trace.h"

namespace glint::test {

// TraceInput and Rays in double precision, owned. One ray is six numbers: origin, direction.
struct ReferenceTraceInput {
  std::size_t count = 0;
  int sh_degree = 3;
  std::vector<double> means, scales, rotations, opacities, sh_dc, sh_rest, rays;
  std::size_t num_rays() const { return rays.size() / 6; }
};
ReferenceTraceInput reference_trace_input(const TraceInput& input, const Rays& rays);

struct ReferenceRay {
  Vec3d color{}, normal{};
  double alpha = 0, depth_sum = 0;
  int hits = 0;
  // Relative distance to the next jump (rho, alpha, near, transmittance, order of two hits, clamp).
  double nearest_cutoff = std::numeric_limits<double>::infinity();
};
ReferenceRay reference_trace(
    const ReferenceTraceInput& input, std::size_t ray, const TraceSettings& settings
);

}  // namespace glint::test
