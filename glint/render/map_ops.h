// SPDX-License-Identifier: MIT
// Maps made of a rasterised set's: expected and plane depth, unit normals, colour; and the way
// back.
#pragma once

#include "glint/render/rasterize.h"
#include "glint/scene/maps.h"

namespace glint {

// Expected depth of a rasterised set, [H][W][1]; 0: nothing hit.
void expected_depth_map(const RasterOutput& output, Image& depth);
// Adds to the gradients of depth_sum and alpha.
void expected_depth_map_vjp(
    const RasterOutput& output, const Image& dL_ddepth, RasterOutputGradient& dL_doutput
);
// The maps "behind_expected" and "behind_median" of the set that stands for what is behind glass,
// with 0 where nothing was hit: what every method's depth behind glass is scored by, besides its
// own.
void add_depth_estimates(const RasterOutput& output, MapSet& maps);
// The maps "first_mode" and "last_mode" (depth_modes.h) and "alpha" of what was rasterised last,
// which is what the method's depth is of. Made after the pass, pixel by pixel: for renders, not for
// training.
void add_depth_modes(Rasterizer& rasterizer, MapSet& maps);
// Depth of each pixel's plane (plane_depth.h), [H][W][1]; 0: none. distance, normal: composited.
void plane_depth_map(
    const Camera& camera, const Image& distance, const Image& normal, Image& depth
);
// Adds to the gradients of distance and normal.
void plane_depth_map_vjp(
    const Camera& camera,
    const Image& distance,
    const Image& normal,
    const Image& dL_ddepth,
    Image& dL_ddistance,
    Image& dL_dnormal
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
// The gradient of the colour alone, of such a set.
void color_gradient(const Image& dL_dcolor, int features, RasterOutputGradient& dL_doutput);

}  // namespace glint
