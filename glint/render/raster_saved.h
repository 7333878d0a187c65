// SPDX-License-Identifier: MIT
// What Rasterizer keeps between calls on the CPU, and its passes there. Arguments are checked,
// outputs and gradients have their shapes.
#pragma once

#include <cstdint>
#include <vector>

#include "glint/render/pixel_pass.h"
#include "glint/render/raster_tiles.h"
#include "glint/render/rasterize.h"

namespace glint {

struct RasterSaved {
  TileLists lists;
  Image final_transmittance;  // [H][W][1]
  // Of the distortion loss, [H][W][1]: depth of the first hit; sum w m, sum w m^2 relative to it.
  Image first_depth, moment1, moment2;
  std::vector<float> pair_visibility;  // [pairs]
  // [pairs] blocks of the tile where a pixel has a hit, one bit each: backward looks at no others.
  std::vector<std::uint8_t> pair_blocks;
  std::vector<float> pair_gradients;  // [pairs][slot_width]
};

inline DistortionRange distortion_range(const RasterSettings& settings) {
  return {settings.with_distortion, settings.distortion_near, settings.distortion_far};
}

void rasterize_forward_cpu(
    const RasterInput& input,
    const Camera& camera,
    const RasterSettings& settings,
    RasterOutput& output,
    bool scalar,
    RasterSaved& saved
);
void rasterize_backward_cpu(
    const RasterInput& input,
    const Camera& camera,
    const RasterSettings& settings,
    const RasterOutput& output,
    const RasterOutputGradient& dL_doutput,
    RasterGradient& gradient,
    bool scalar,
    RasterSaved& saved
);
std::size_t raster_pixel_pairs(const RasterSaved& saved);  // of the surfels' screen boxes

}  // namespace glint
