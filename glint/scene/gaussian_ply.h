// SPDX-License-Identifier: MIT
// Gaussians as programs of the field write them, read as surfels: 2DGS and EnvGS (two scales),
// 3DGS, PGSR, gsplat, nerfstudio (three scales), and our own.
#pragma once

#include <string>
#include <vector>

#include "glint/core/files.h"
#include "glint/scene/surfels.h"

namespace glint {

// How far ellipsoids are from surfels: the share of the smallest scale in the middle one.
struct Flatness {
  float median = 0, percentile_90 = 0;
};

struct GaussianPly {
  SurfelCloud cloud;
  bool has_ellipsoids = false;  // three scales: the smallest and its axis were dropped
  Flatness flatness;            // of ellipsoids
};

// Extra channels are those that the file has of `wanted` (their names here), in that order, also
// under the names that official code gives them ("transmission_coeff"); the file's other extra
// fields are named in `ignored`. Errors (kBadReference): read_surfel_ply()'s; a compressed file; no
// scale or one; a wanted channel that is missing.
GaussianPly read_gaussian_ply(
    const fs::path& path, const std::vector<std::string>& wanted, std::vector<std::string>& ignored
);

}  // namespace glint
