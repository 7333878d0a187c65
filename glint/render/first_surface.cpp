// SPDX-License-Identifier: MIT
// First surfaces on the CPU, from the lists of the last rasterisation.
#include "glint/render/first_surface.h"

#include <algorithm>

#include "glint/core/parallel.h"
#include "glint/render/raster_tiles.h"
#include "glint/render/surface_pixel.h"

namespace glint {

SurfaceHits surface_hits(const RasterCall& call, const TileLists& lists, int x, int y) {
  const ImageView limit = call.input.near_limit.view();
  const float near = call.settings.near_plane;
  SurfacePixel pixel(x, y, limit.empty() ? near : std::max(near, limit.at(x, y)));
  const int tile = y / kTileSize * lists.tiles_x + x / kTileSize;
  for (std::uint32_t k = lists.tile_begin[tile]; k < lists.tile_begin[tile + 1]; ++k)
    if (!pixel.add(lists.splats[lists.entries[k]])) break;
  return pixel.hits;
}

void first_surface_on_cpu(
    const RasterCall& call,
    const TileLists& lists,
    const RasterOutput& output,
    ImageView mask,
    const FirstSurfaceSettings& settings,
    Image& depth
) {
  const auto width = static_cast<std::size_t>(depth.width());
  parallel_for(depth.num_pixels(), 64, [&](std::size_t i) {
    const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
    float& z = depth.at(x, y);
    if (1 - output.alpha.at(x, y) > settings.max_transmittance)
      z = 0;
    else if (mask.at(x, y) > 0.5f)
      z = first_surface_depth(surface_hits(call, lists, x, y), settings);
    else
      z = output.depth_median.at(x, y);
  });
}

}  // namespace glint
