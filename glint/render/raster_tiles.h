// SPDX-License-Identifier: MIT
// CPU rasterisation, first half: surfels projected to splats, sorted by depth and listed per tile.
#pragma once

#include <cstdint>
#include <vector>

#include "glint/render/pixel_pass.h"
#include "glint/render/radix_sort.h"
#include "glint/render/rasterize.h"

namespace glint {

// (surfel, tile) pairs are listed by tiles, as they are worked on, so that what a tile writes of
// them lies in a row. Surfels find theirs by `places`.
struct TileLists {
  int tiles_x = 0, tiles_y = 0;
  std::vector<Splat> splats;              // [N]
  std::vector<PixelBox> boxes;            // [N]
  std::vector<std::uint32_t> pair_begin;  // [N + 1] into `places`, the first of each surfel
  std::vector<std::uint32_t> places;      // [pairs] into `entries`, of each surfel's pairs
  std::vector<std::uint32_t> tile_begin;  // [tiles + 1] into `entries`
  std::vector<std::uint32_t> entries;     // [pairs] surfels of each tile, front to back

  std::size_t num_tiles() const { return static_cast<std::size_t>(tiles_x) * tiles_y; }
  std::size_t num_pairs() const { return entries.size(); }

  std::vector<KeyedIndex> order, scratch;  // reused between calls
};

// Pairs are counted in 32 bits on every backend. Errors (kUsage): the image of `size` pixels has
// more of them than `most`.
void check_num_pairs(bool countable, std::size_t most, std::size_t surfels, ImageSize size);
// The first pair of each surfel, and at last how many there are; errors: see check_num_pairs().
void number_pairs(
    const std::vector<PixelBox>& boxes, ImageSize size, std::vector<std::uint32_t>& pair_begin
);

CameraOf<float> camera_of(const RasterCall& call);
inline DistortionRange distortion_range(const RasterSettings& settings) {
  return {settings.with_distortion, settings.distortion_near, settings.distortion_far};
}
template <class T>
CameraOf<T> broadcast_camera(const CameraOf<float>& c) {
  const auto lift = [](Vec3f v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
  return {
      {{lift(c.rotation.rows[0]), lift(c.rotation.rows[1]), lift(c.rotation.rows[2])}},
      lift(c.translation),
      T(c.fx),
      T(c.fy),
      T(c.cx),
      T(c.cy),
      T(c.width),
      T(c.height),
      T(c.near_plane)};
}

// Geometry of surfel i (and the next lanes) of the input.
template <class T>
SurfelGeometry<T> load_geometry(const RasterInput& input, std::size_t i);

void build_tile_lists(const RasterCall& call, TileLists& lists);  // fills `lists`

// Hits of a pixel of what was listed.
SurfaceHits surface_hits(const RasterCall& call, const TileLists& lists, int x, int y);
// Rasterizer::first_surface() of what was listed; `depth` has the image's size.
void first_surface_on_cpu(
    const RasterCall& call,
    const TileLists& lists,
    const RasterOutput& output,
    ImageView mask,
    const FirstSurfaceSettings& settings,
    Image& depth
);
// Rasterizer::depth_modes() of what was listed; both maps have the image's size.
void depth_modes_on_cpu(
    const RasterCall& call,
    const TileLists& lists,
    const DepthModeSettings& settings,
    Image& first,
    Image& last
);

}  // namespace glint
