// SPDX-License-Identifier: MIT
// Texture look-up: bilinear between texel centres, repeated in both directions. uv (0, 0) is the
// outer corner of the first texel of the first row; v grows with the rows.
#pragma once

#include "glint/core/image.h"
#include "glint/core/vec.h"

namespace glint::path_tracing {

Vec3f sample_texture(ImageView texture, Vec2f uv);

// Asks for the texels of a look-up ahead of time: a room's textures do not fit into the caches.
void prefetch_texture(ImageView texture, Vec2f uv);

}  // namespace glint::path_tracing
