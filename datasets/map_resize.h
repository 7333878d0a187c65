// SPDX-License-Identifier: MIT
// Resizing of maps that must not be blended across edges: depth, normals, masks.
#pragma once

#include "glint/core/image.h"

namespace glint {

// Planar depth [H][W][1], 0 where missing. Each new pixel gets the mean inverse depth of the
// surface that fills most of it (inverse depth is affine on a plane, so planes stay exact); 0 where
// more than half of its area is missing.
Image resize_depth(ImageView depth, ImageSize size);

// Unit normals [H][W][3], zero where missing: area mean, then renormalised.
Image resize_normal(ImageView normal, ImageSize size);

// 255 where at least half of the area counts.
MaskImage resize_mask(MaskView mask, ImageSize size);

}  // namespace glint
