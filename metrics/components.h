// SPDX-License-Identifier: MIT
// The two radiance components at glass, transmitted and reflected, in display values. Methods train
// on displayed (sRGB-encoded) images, where radiance does not add; so a pixel's true component is
// the displayed pixel times the component's share of the linear radiance, per channel. The two add
// up to the pixel, as the two terms of a method's transport do.
#pragma once

#include <vector>

#include "glint/core/image.h"
#include "glint/scene/maps.h"

namespace glint {

// displayed * component / (component + other) per channel and pixel; 0 where both radiances are 0.
// displayed: [H][W][3] in [0, 1]; component, other: [H][W][3] linear radiance of any common unit.
// Errors (kBadReference): another size, a radiance that is negative or not finite (pixel named).
Image displayed_component(ImageView displayed, ImageView component, ImageView other);

// The true parts that add up to the radiance with this one: transmitted and reflected, or those by
// path.
std::vector<MapId> other_parts(const MapRow& part);
// The true part against all others; empty where the truth lacks one of them.
Image displayed_part(ImageView displayed, const MapViews& truth, MapId part);

}  // namespace glint
