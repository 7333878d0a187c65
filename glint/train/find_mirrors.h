// SPDX-License-Identifier: MIT
// Which planes of a half-trained scene are mirrors (beyond the paper). Priors call a mirror what
// they call glass, a dark plane. What tells them apart: the camera behind the plane sees in the
// room that was learnt so far what the photos show there.
#pragma once

#include "glint/scene/scene.h"
#include "glint/train/fit_planes.h"
#include "glint/train/plane_mirrors.h"

namespace glint {

struct FindMirrors {
  float low_albedo = 0.05f;  // of what may be a mirror; a view's albedo prior
  // Correlation with the photos from which a plane is a mirror. Measured (docs/design/glint.md).
  double least_likeness = 0.55;
};

// The planes that were looked at, with their likeness and tint. `call`: as in training, whose
// camera is not looked at. Waits for the GPU; needs albedo priors, and finds nothing without.
std::vector<MirrorPlane> candidate_mirrors(
    const Scene& scene, MirroredSets sets, MirrorsCall call, const FindMirrors& settings
);
// Makes surfels faint that stand where a mirror shows the room: behind it, seen through it by one
// of the views.
void fade_behind(const MirrorPlane& plane, const std::vector<View>& views, SurfelCloud& cloud);

}  // namespace glint
