// SPDX-License-Identifier: MIT
// Modes of depth on the CPU, from the lists of the last rasterisation.
#include "glint/render/depth_modes.h"

#include "glint/core/parallel.h"
#include "glint/render/raster_tiles.h"

namespace glint {

void depth_modes_on_cpu(
    const RasterCall& call,
    const TileLists& lists,
    const DepthModeSettings& settings,
    Image& first,
    Image& last
) {
  const auto width = static_cast<std::size_t>(first.width());
  parallel_for(first.num_pixels(), 64, [&](std::size_t i) {
    const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
    const SurfaceHits hits = surface_hits(call, lists, x, y);
    const DepthModes modes = ModeSearch(hits, settings).run();
    first.at(x, y) = modes.first;
    last.at(x, y) = modes.last;
  });
}

}  // namespace glint
