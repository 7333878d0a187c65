// SPDX-License-Identifier: MIT
// Rays of the path tracer on their own, so that Embree can be timed on the very same ones.
#pragma once

#include "glint/core/vec.h"

namespace glint {

struct TracedRay {
  Vec3f origin, direction;  // metres; of a shadow ray the whole segment
  unsigned mask = 0;        // path_tracing::RayMask
  bool shadow = false;      // is anything opaque within the segment; otherwise: the closest hit
};

}  // namespace glint
