// SPDX-License-Identifier: MIT
// Surfels with colours for tests of trace().
#pragma once

#include "glint/render/trace.h"
#include "tests/support/random_scene.h"

namespace glint::test {

// Owned arrays behind a TraceInput.
struct TraceArrays {
  SurfelArrays surfels;
  FloatArray sh_dc, sh_rest;
  int sh_degree = 3;

  TraceInput view() const {
    TraceInput input;
    input.count = surfels.count();
    input.sh_degree = sh_degree;
    input.means = surfels.means;
    input.scales = surfels.scales;
    input.rotations = surfels.rotations;
    input.opacities = surfels.opacities;
    input.sh_dc = sh_dc;
    input.sh_rest = sh_rest;
    return input;
  }
  void add(Vec3d mean, Vec2d scale, Vec4<double> q, double opacity, Rng& rng) {
    surfels.add(mean, scale, q, opacity, {0, 0, 0});
    for (int i = 0; i < 3; ++i) sh_dc.push_back(rng.uniform(-1, 1));
    for (int i = 0; i < 45; ++i) sh_rest.push_back(0.2f * rng.uniform(-1, 1));
  }
};

}  // namespace glint::test
