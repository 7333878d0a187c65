// SPDX-License-Identifier: MIT
// Rasterisation on the GPU, first half, as kernels: surfels projected to splats and listed per
// tile, sorted by depth. Formulas: project.h.
#pragma once

#include "glint/cuda/block.h"
#include "glint/cuda/geometry_revision.h"
#include "glint/render/radix_sort.h"
#include "glint/render/splat_hit.h"

namespace glint::gpu {

// A tile is a block's, a patch a warp's: one thread a pixel.
inline constexpr int kDeviceTile = 16;  // pixels, either way
inline constexpr int kTileThreads = kDeviceTile * kDeviceTile;
inline constexpr int kPatchWidth = 8, kPatchHeight = 4;
inline constexpr int kPatchesAcross = kDeviceTile / kPatchWidth;  // of a tile
inline constexpr int kPatchesDown = kDeviceTile / kPatchHeight;
static_assert(kPatchWidth * kPatchHeight == kWarp);

// Activated surfels in device memory; shapes of RasterInput.
struct DeviceSurfels {
  std::size_t count;
  int channels;
  const float *means, *scales, *rotations, *opacities, *features;
};

GLINT_HD SurfelGeometry<float> geometry_at(const DeviceSurfels& s, std::size_t i) {
  const float *m = s.means + 3 * i, *q = s.rotations + 4 * i;
  return {{m[0], m[1], m[2]}, {s.scales[2 * i], s.scales[2 * i + 1]}, {q[0], q[1], q[2], q[3]}};
}

struct TileGrid {
  int across, down;  // tiles
  GLINT_HD int count() const { return across * down; }
};
GLINT_HD TileGrid tile_grid(int width, int height) {
  return {(width + kDeviceTile - 1) / kDeviceTile, (height + kDeviceTile - 1) / kDeviceTile};
}

// Tiles or patches [x0, x1) x [y0, y1) that a box touches.
struct CellRect {
  int x0, x1, y0, y1;
  GLINT_HD int across() const { return x1 - x0; }
  GLINT_HD std::uint32_t count() const { return static_cast<std::uint32_t>(across() * (y1 - y0)); }
};
template <int kWidth, int kHeight>
GLINT_HD CellRect cells_of(const PixelBox& box) {
  if (box.empty()) return {0, 0, 0, 0};
  return {
      box.x_min / kWidth,
      (box.x_max + kWidth - 1) / kWidth,
      box.y_min / kHeight,
      (box.y_max + kHeight - 1) / kHeight};
}
GLINT_HD CellRect tiles_of(const PixelBox& box) { return cells_of<kDeviceTile, kDeviceTile>(box); }
GLINT_HD CellRect patches_of(const PixelBox& box) {
  return cells_of<kPatchWidth, kPatchHeight>(box);
}

// Two counts in one number, so that they are summed in one go: (surfel, tile) pairs, and slots,
// (surfel, patch) pairs.
using PairCounts = std::uint64_t;
GLINT_HD PairCounts pair_counts(std::uint32_t pairs, std::uint32_t slots) {
  return PairCounts{slots} << 32 | pairs;
}
GLINT_HD std::uint32_t pairs_of(PairCounts counts) { return static_cast<std::uint32_t>(counts); }
GLINT_HD std::uint32_t slots_of(PairCounts counts) {
  return static_cast<std::uint32_t>(counts >> 32);
}
// Each count stays at the largest there is once it got there: what was too much cannot be mistaken
// for little, nor reach into the other count. Associative, so that any order of sums will do.
struct AddPairCounts {
  GLINT_HD static std::uint32_t add(std::uint32_t a, std::uint32_t b) {
    return a + b < a ? ~0u : a + b;
  }
  GLINT_HD PairCounts operator()(PairCounts a, PairCounts b) const {
    return pair_counts(add(pairs_of(a), pairs_of(b)), add(slots_of(a), slots_of(b)));
  }
};

struct ProjectSurfels {
  DeviceSurfels surfels;
  CameraOf<float> camera;
  Splat* splats;
  PixelBox* boxes;
  PairCounts* counts;

  GLINT_HD void operator()(std::size_t i) const {
    const float opacity = surfels.opacities[i];
    const ProjectedSurfel<float> p =
        project_surfel(geometry_at(surfels, i), camera, max_rho_of(opacity));
    const PixelBox box = pixel_box(p.box_min_x, p.box_max_x, p.box_min_y, p.box_max_y, camera);
    splats[i] = splat_of(p, opacity);
    boxes[i] = box;
    counts[i] = pair_counts(tiles_of(box).count(), patches_of(box).count());
  }
};

// What memory has room for.
struct PairRoom {
  std::uint32_t pairs = 0, slots = 0;
};
// CUB sorts as many pairs as an int counts. Slots are below what AddPairCounts stays at, by more
// than a warp's lanes, which are counted beyond the last.
inline constexpr PairRoom kMostPairs{0x7fffffffu, 0xffffff00u};
// What there is to list. Where there is no room for it, nothing is.
struct PairTotals {
  std::uint32_t pairs, slots;
  std::uint32_t fit;  // 1 or 0
  GLINT_HD std::uint32_t listed() const { return fit != 0 ? pairs : 0; }
};
struct TakeTotals {
  const PairCounts* total;
  PairRoom room;
  PairTotals* totals;
  std::uint32_t* overflow;  // 1 from now on where there was no room; may be null

  GLINT_HD void operator()(std::size_t) const {
    const std::uint32_t pairs = pairs_of(*total), slots = slots_of(*total);
    const bool fit = pairs <= room.pairs && slots <= room.slots;
    *totals = {pairs, slots, fit ? 1u : 0u};
    if (!fit && overflow != nullptr) *overflow = 1;
  }
};

// Keys are (tile, depth of the centre); pairs are written surfel by surfel, so that a stable sort
// leaves ties in the order of the surfels.
struct WritePairs {
  const Splat* splats;
  const PixelBox* boxes;
  const PairCounts* first;
  const PairTotals* totals;
  TileGrid grid;
  std::uint64_t* keys;
  std::uint32_t* surfels;

  GLINT_HD void operator()(std::size_t i) const {
    if (totals->fit == 0) return;
    const CellRect rect = tiles_of(boxes[i]);
    std::uint32_t pair = pairs_of(first[i]);
    for (int y = rect.y0; y < rect.y1; ++y)
      for (int x = rect.x0; x < rect.x1; ++x, ++pair) {
        const auto tile = static_cast<std::uint64_t>(y * grid.across + x);
        keys[pair] = tile << 32 | sortable_bits(splats[i].z_center);
        surfels[pair] = static_cast<std::uint32_t>(i);
      }
  }
};

// Room behind the last pair: keys of no tile, the largest there are.
struct ClearTail {
  const PairTotals* totals;
  std::uint64_t* keys;
  std::uint32_t* surfels;
  GLINT_HD void operator()(std::size_t i) const {
    if (i < totals->listed()) return;
    keys[i] = ~std::uint64_t{0};
    surfels[i] = 0;
  }
};

struct PairRange {
  std::uint32_t begin = 0, end = 0;
};
// Ranges of tiles without pairs stay as they were: empty.
struct FindTileRanges {
  const std::uint64_t* keys;
  const PairTotals* totals;
  PairRange* ranges;

  GLINT_HD void operator()(std::size_t i) const {
    const std::uint32_t count = totals->listed();
    if (i >= count) return;
    const std::uint64_t tile = keys[i] >> 32;
    if (i == 0 || keys[i - 1] >> 32 != tile) ranges[tile].begin = static_cast<std::uint32_t>(i);
    if (i + 1 == count || keys[i + 1] >> 32 != tile)
      ranges[tile].end = static_cast<std::uint32_t>(i + 1);
  }
};

// Lists in device memory, as the passes over tiles read them.
struct DeviceLists {
  std::size_t count;  // surfels
  int width, height;  // pixels
  const Splat* splats;
  const PixelBox* boxes;
  const PairCounts* first;  // of each surfel: its first pair and slot; [count + 1]
  const PairTotals* totals;
  const std::uint32_t* pairs;  // surfels of each tile, front to back
  const PairRange* ranges;     // of each tile, of pairs

  GLINT_HD int tile_x(int tile) const { return tile % tile_grid(width, height).across; }
  GLINT_HD int tile_y(int tile) const { return tile / tile_grid(width, height).across; }
  GLINT_HD bool in_view(std::size_t surfel) const { return !boxes[surfel].empty(); }
  GLINT_HD std::uint32_t first_slot(std::size_t surfel) const {
    return totals->fit != 0 ? slots_of(first[surfel]) : 0;
  }
};

}  // namespace glint::gpu
