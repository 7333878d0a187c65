// SPDX-License-Identifier: MIT
// The passes of a tile with sixteen lanes, for processors with AVX-512.
#pragma once

#include "glint/render/raster_visitors.h"

namespace glint {

struct WideTiles {
  void (*forward)(const TileContext& tile, RasterSaved& saved, RasterOutput& out);
  void (*backward
  )(const TileContext& tile,
    RasterSaved& saved,
    const RasterOutput& out,
    const RasterOutputGradient& dL_dout);
};
// Empty in programs that were compiled for no such processor.
extern const WideTiles kWideTiles;

// Whether this processor and this program have them. GLINT_LANES=8 in the environment: no.
bool has_wide_tiles();

}  // namespace glint
