// SPDX-License-Identifier: MIT
// Which planes of a half-trained scene are mirrors, and where its panes of glass are (beyond the
// paper). Priors call both a dark plane. What tells a mirror: the camera behind the plane sees in
// the room that was learnt so far what the photos show there. A pane lies as the mean of normal
// priors says, where all views see the same outline; where they see none of it, it is one if that
// camera explains what the photos have beside what is seen through it.
#pragma once

#include "glint/scene/scene.h"
#include "glint/train/fit_planes.h"
#include "glint/train/plane_mirrors.h"

namespace glint {

struct FindMirrors {
  float low_albedo = 0.05f;  // of what may be a mirror; a view's albedo prior
  // Correlation with the photos from which a plane is a mirror, and of what is left of the photos
  // from which one without outlines is a pane. Measured (docs/design/glint.md).
  double least_likeness = 0.55, least_remainder = 0.2;
  bool panes = false;  // looks whether a plane that is no mirror is a pane
};

// Whether it shows what it mirrors: by its likeness or, for a pane, by its outlines.
inline bool is_mirroring(const MirrorPlane& plane, const FindMirrors& settings) {
  if (plane.pane) return plane.outlined > 0 || plane.likeness >= settings.least_remainder;
  return plane.likeness >= settings.least_likeness;
}

// The planes that were looked at, with their likeness and tint; those that are no mirrors as panes,
// if these are asked for. `call`: as in training, whose camera is not looked at. Waits for the GPU;
// needs albedo priors, and finds nothing without.
std::vector<MirrorPlane> candidate_mirrors(
    const Scene& scene, MirroredSets sets, MirrorsCall call, const FindMirrors& settings
);
// Makes surfels faint that stand where a mirror shows the room: behind it, seen through it by one
// of the views.
void fade_behind(const MirrorPlane& plane, const std::vector<View>& views, SurfelCloud& cloud);

}  // namespace glint
