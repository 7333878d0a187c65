// SPDX-License-Identifier: MIT
// Maps made of a rasterised set's: expected depth, unit normals, colour; and the way back.
#pragma once

#include "glint/render/rasterize.h"

namespace glint {

// Expected depth of a rasterised set, [H][W][1]; 0: nothing hit.
void expected_depth_map(const RasterOutput& output, Image& depth);
// Adds to the gradients of depth_sum and alpha.
void expected_depth_map_vjp(
    const RasterOutput& output, const Image& dL_ddepth, RasterOutputGradient& dL_doutput
);
// Camera-space unit normals; zero: nothing hit.
Image unit_normals(const Image& normal);
// The first three of some feature channels.
void copy_color(const Image& features, Image& color);
// Adds to the first three.
void add_color(const Image& color, Image& features);

// Zeros of a shape.
void clear_image(Image& image, ImageSize size, int channels);
// Zeros of the shapes of a rasterised set with so many features; no median, no distortion.
void clear_gradient(ImageSize size, int features, RasterOutputGradient& dL_doutput);

}  // namespace glint
