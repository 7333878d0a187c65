// SPDX-License-Identifier: MIT
// CPU rasterisation, second half: the loop over one tile's hits. Forward and backward run the same
// traversal with different visitors, so they cannot drift. T: Float16, Float8 or float.
#pragma once

#include <bit>

#include "glint/core/simd.h"
#include "glint/render/pixel_pass.h"
#include "glint/render/raster_tiles.h"

namespace glint {

// A tile's pixels in blocks of 4x2 that are culled together: squarer than a row of eight, so small
// splats fill more lanes. The second half of the blocks lie below those of the first. A group is
// what one T holds: a block and the one below it, a block, or one pixel of it.
inline constexpr int kBlockWidth = 4, kBlockHeight = 2, kBlockPixels = kBlockWidth * kBlockHeight;
inline constexpr int kBlocksAcross = kTileSize / kBlockWidth;
inline constexpr int kBlocksPerHalf = kTileSize * kTileSize / kBlockPixels / 2;
template <class T>
inline constexpr int kGroupsPerTile = kTileSize* kTileSize / kLanesOf<T>;

struct PixelOffset {
  int x, y;
};
// Place of a lane of a group within its tile.
template <class T>
constexpr PixelOffset pixel_of(int group, int lane) {
  const int first = kLanesOf<T> > kBlockPixels ? group * kBlockPixels : group * kLanesOf<T>;
  const int block = first / kBlockPixels;
  const int pixel = first % kBlockPixels + lane;  // beyond a block: in the one below
  const int row = block % kBlocksPerHalf / kBlocksAcross * 2 + block / kBlocksPerHalf;
  return {
      block % kBlocksAcross * kBlockWidth + pixel % kBlockWidth,
      row * kBlockHeight + pixel / kBlockWidth};
}
// Offsets of a group's lanes from its first.
template <class T>
Vec2<T> lane_offsets() {
  alignas(64) static constexpr float kX[] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
  alignas(64) static constexpr float kY[] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
  return {load_lanes<T>(kX), load_lanes<T>(kY)};
}

// Halves of a tile that are summed apart, so that every width adds in the same order: lanes 8 to 15
// of a Float16 are those of the second half's blocks.
template <class T>
inline constexpr int kHalves = kLanesOf<T> == kBlockPixels ? 2 : 1;
template <class T>
constexpr int half_of(int group) {
  return kHalves<T> == 1 ? 0 : group / kBlocksPerHalf;
}
// Both halves of what lies `stride` apart, as eight lanes.
template <class T>
GLINT_SIMD_INLINE Float8 both_halves(const T* sums, int stride) {
  if constexpr (kHalves<T> == 1)
    return sum_of_halves(*sums);
  else
    return sums[0] + sums[stride];
}
template <class T>
GLINT_SIMD_INLINE float tile_sum(const T* halves) {
  if constexpr (kLanesOf<T> == 1)
    return *halves;
  else
    return lane_sum(both_halves(halves, 1));
}

struct TileContext {
  const RasterCall& call;
  const TileLists& lists;
  ImageSize size;
  int tile_x, tile_y;
  MapChannels has;       // of the call
  ImageView near_limit;  // too

  const float* feature(std::uint32_t surfel) const {
    return &call.input.features[static_cast<std::size_t>(surfel) * call.input.channels];
  }

  // Of an entry that is soon to come: surfels lie scattered in memory.
  void prefetch(std::uint32_t place) const {
    const std::uint32_t surfel = lists.entries[place];
    const char* splat = reinterpret_cast<const char*>(&lists.splats[surfel]);
    __builtin_prefetch(splat);
    __builtin_prefetch(splat + sizeof(Splat) - 1);
    __builtin_prefetch(feature(surfel));
    __builtin_prefetch(&lists.boxes[surfel]);
  }

  int x0() const { return tile_x * kTileSize; }
  int y0() const { return tile_y * kTileSize; }
  bool is_needed() const;  // whether anyone looks at one of its pixels
  std::uint32_t list_begin() const { return lists.tile_begin[tile_y * lists.tiles_x + tile_x]; }
  std::uint32_t list_end() const { return lists.tile_begin[tile_y * lists.tiles_x + tile_x + 1]; }
};

// Calls f(lane, x, y) for the lanes of a group that lie inside the image.
template <class T, class F>
void for_each_lane(const TileContext& tile, int group, F&& f) {
  const PixelOffset first = pixel_of<T>(group, 0);
  const int x = tile.x0() + first.x, y = tile.y0() + first.y;
  constexpr int kAcross = kLanesOf<T> == 1 ? 1 : kBlockWidth;
  const int across = std::min(kAcross, tile.size.width - x);
  const int down = std::min(kLanesOf<T> / kAcross, tile.size.height - y);
  for (int j = 0; j < down; ++j)
    for (int i = 0; i < across; ++i) f(j * kAcross + i, x + i, y + j);
}

// One group's pixels of a map, [channels][lanes], gathered from and scattered to image rows; lanes
// outside the image get `outside`.
template <class T>
void load_pixels(
    const TileContext& tile, const ImageView& map, int group, int channels, float outside, T* values
) {
  alignas(64) float lanes[kMaxChannels][kLanesOf<T>];
  for (int c = 0; c < channels; ++c) std::fill_n(lanes[c], kLanesOf<T>, outside);
  for_each_lane<T>(tile, group, [&](int i, int x, int y) {
    const float* pixel = map.pixel(x, y);
    for (int c = 0; c < channels; ++c) lanes[c][i] = pixel[c];
  });
  for (int c = 0; c < channels; ++c) values[c] = load_lanes<T>(lanes[c]);
}
template <class T>
void store_pixels(
    const TileContext& tile, const ImageRef& map, int group, int channels, const T* values
) {
  alignas(64) float lanes[kMaxChannels][kLanesOf<T>];
  for (int c = 0; c < channels; ++c) store_lanes(lanes[c], values[c]);
  for_each_lane<T>(tile, group, [&](int i, int x, int y) {
    float* pixel = map.pixel(x, y);
    for (int c = 0; c < channels; ++c) pixel[c] = lanes[c][i];
  });
}

// State of a tile's pixels while it is traversed.
template <class T>
struct TilePixels {
  T x[kGroupsPerTile<T>], y[kGroupsPerTile<T>];  // pixel centres
  T transmittance[kGroupsPerTile<T>];            // negative once stopped; 0 outside the image
  T nearest[kGroupsPerTile<T>];                  // only hits behind this depth count

  explicit TilePixels(const TileContext& tile) {
    for (int g = 0; g < kGroupsPerTile<T>; ++g) {
      const PixelOffset first = pixel_of<T>(g, 0);
      const Vec2<T> lane = lane_offsets<T>();
      x[g] = T(static_cast<float>(tile.x0() + first.x) + 0.5f) + lane.x;
      y[g] = T(static_cast<float>(tile.y0() + first.y) + 0.5f) + lane.y;
      const auto inside = (x[g] < T(static_cast<float>(tile.size.width))) &
                          (y[g] < T(static_cast<float>(tile.size.height)));
      transmittance[g] = select(inside, T(1), T(0));
      nearest[g] = T(tile.call.settings.near_plane);
      if (tile.near_limit.empty()) continue;
      T behind;
      load_pixels(tile, tile.near_limit, g, 1, 0.0f, &behind);
      nearest[g] = max_of(nearest[g], behind);
    }
  }
  T final_transmittance(int g) const { return abs_of(transmittance[g]); }
  // Bit g: some pixel of group g is inside the image and not stopped.
  std::uint64_t live_groups() const {
    std::uint64_t live = 0;
    for (int g = 0; g < kGroupsPerTile<T>; ++g)
      live |= static_cast<std::uint64_t>(any(transmittance[g] > T(0))) << g;
    return live;
  }
};

// The hit of one splat at one group, composited. Lanes that do not count have weight and depth 0.
template <class T, class Visitor>
void visit_group(
    const Splat& splat, const PixelPlaneMap<T>& map, int g, TilePixels<T>& pixels, Visitor& visitor
) {
  auto&& hit = visitor.room_for_hit();
  const bool counts = composite_splat(
      splat, map, pixels.x[g], pixels.y[g], pixels.nearest[g], pixels.transmittance[g], hit
  );
  if (counts) visitor.hit(g, hit);
}

// The groups of some of a tile's blocks; one bit each, as the blocks have.
template <class T>
std::uint64_t groups_of_blocks(unsigned blocks) {
  if constexpr (kLanesOf<T> == kBlockPixels) return blocks;
  if constexpr (kLanesOf < T >> kBlockPixels)
    return (blocks | blocks >> kBlocksPerHalf) & ((1u << kBlocksPerHalf) - 1);
  std::uint64_t groups = 0;
  for (int block = 0; block < 2 * kBlocksPerHalf; ++block)
    groups |= (std::uint64_t{blocks} >> block & 1) * 0xff << (block * kBlockPixels);
  return groups;
}
// Of a group's first block; where it has two, either stands for both.
template <class T>
constexpr int block_of(int group) {
  return kLanesOf<T> > kBlockPixels ? group : group * kLanesOf<T> / kBlockPixels;
}

// Blocks of a tile that a splat's box overlaps.
GLINT_SIMD_INLINE unsigned blocks_of(const TileContext& tile, const PixelBox& box) {
  // Of the blocks' rows from the first on, none to all.
  constexpr unsigned kRows[] = {0, 0x03, 0x33, 0x3f, 0xff};
  const int x0 = box.x_min - tile.x0(), x1 = box.x_max - tile.x0();
  const int y0 = std::max(0, box.y_min - tile.y0()) / kBlockHeight;
  const int y1 = (std::min(kTileSize, box.y_max - tile.y0()) + kBlockHeight - 1) / kBlockHeight;
  static_assert(kBlocksAcross == 2 && kBlocksPerHalf == 4);
  const unsigned columns = (x0 < kBlockWidth ? 0x55u : 0u) | (x1 > kBlockWidth ? 0xaau : 0u);
  return columns & kRows[y1] & ~kRows[y0];
}

// Entries between two looks at which groups are still live: rarely, because the groups of the next
// splat would otherwise wait for the transmittance behind the last.
inline constexpr std::uint32_t kEntriesPerLook = 16;
inline constexpr std::uint32_t kEntriesAhead = 8;  // that are prefetched

// All hits of a tile, front to back. Visitor: groups(place), those to look at; begin(surfel),
// room_for_hit() and hit(group, hit), end(place); skip(place) for those without such groups or
// behind everything, and for all of a tile that nobody needs.
template <class T, class Visitor>
void for_each_hit(const TileContext& tile, TilePixels<T>& pixels, Visitor& visitor) {
  const std::uint32_t begin = tile.list_begin(), end = tile.list_end();
  const std::uint32_t last = tile.is_needed() ? end : begin;
  std::uint64_t live = 0;
  std::uint32_t k = begin;
  for (; k < last; ++k) {
    if ((k - begin) % kEntriesPerLook == 0 && (live = pixels.live_groups()) == 0) break;
    const std::uint32_t surfel = tile.lists.entries[k];
    tile.prefetch(std::min(k + kEntriesAhead, end - 1));
    std::uint64_t groups = visitor.groups(k) & live;
    if (groups == 0) {
      visitor.skip(k);
      continue;
    }
    visitor.begin(surfel);
    const Splat& splat = tile.lists.splats[surfel];
    const PixelPlaneMap<T> map = broadcast_map<T>(splat.map);
    for (; groups != 0; groups &= groups - 1)
      visit_group(splat, map, std::countr_zero(groups), pixels, visitor);
    visitor.end(k);
  }
  for (; k < end; ++k) visitor.skip(k);
}

}  // namespace glint
