// SPDX-License-Identifier: MIT
// Surfels themselves, for people who want to see what a model is made of: opaque discs, or points.
#pragma once

#include <optional>
#include <vector>

#include "glint/method.h"
#include "reports/show/viewer/look.h"

namespace glint {

// "rgb" (a surfel's constant colour, darker the more it is turned away), "depth" and "normal" of
// the nearest surfels of all sets; fainter than 0.05 they are left out. A disc reaches to one
// standard deviation; a point is about three pixels wide.
MapSet draw_surfels(
    const std::vector<MethodSet>& sets,
    const Camera& camera,
    SurfelStyle style,
    const std::optional<CutPlane>& cut
);

// Is it taken away by the plane?
bool is_cut(const CutPlane& cut, Vec3f mean);

}  // namespace glint
