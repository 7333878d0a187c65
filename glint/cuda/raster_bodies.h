// SPDX-License-Identifier: MIT
// Rasterisation on the GPU, second half, as bodies (block.h): a block a tile, a warp a patch of it,
// a thread a pixel, each warp through those splats of its tile's list whose boxes touch its patch.
// Formulas: splat_hit.h, pixel_pass.h.
//
// What a warp sums of a splat goes to places of its own, so that sums need no atomics and are the
// same in every run; raster_sums.h adds them up per surfel, in the order of the surfel's slots.
// A slot is a (surfel, patch) pair; slots that a surfel is seen in have a rank among its slots, and
// only they have gradients, so that those take memory for what is seen, not for what is listed.
#pragma once

#include <type_traits>

#include "glint/cuda/raster_lists.h"
#include "glint/render/depth_modes.h"
#include "glint/render/pixel_pass.h"
#include "glint/render/surface_pixel.h"

namespace glint::gpu {

// What both passes over a tile read.
struct TilePass {
  DeviceLists lists;
  const float* features;    // [N][C]
  const float* near_limit;  // [H][W] or null
  float near_plane;
  MapChannels has;
  DistortionRange range;

  GLINT_HD const float* feature(std::uint32_t surfel) const {
    return features + static_cast<std::size_t>(surfel) * static_cast<std::size_t>(has.features);
  }
};

// What the forward pass leaves of every slot.
inline constexpr float kStopsOnly = -1;  // visibility of a splat that only stopped pixels
inline constexpr std::uint32_t kUnseen = ~0u;
struct DeviceSlots {
  float* visibility;     // sum of w; kStopsOnly; 0: not seen
  std::uint8_t* owned;   // pixels that the splat owns, where seen; null: not asked for
  std::uint32_t* ranks;  // among the surfel's slots that were seen, or kUnseen
};

// Of a channel of pixel i in a map of so many.
GLINT_HD std::size_t place(std::size_t i, int channels, int channel) {
  return i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(channel);
}

// A pixel while its tile is traversed.
struct TilePixel {
  float x, y;                    // centre
  float nearest, transmittance;  // negative once stopped; 0 outside the image

  GLINT_HD void start(const TilePass& pass, int tile, int thread) {
    const int patch = thread / kWarp, lane = thread % kWarp;
    const int column = patch % kPatchesAcross * kPatchWidth + lane % kPatchWidth;
    const int row = patch / kPatchesAcross * kPatchHeight + lane / kPatchWidth;
    x = static_cast<float>(pass.lists.tile_x(tile) * kDeviceTile + column) + 0.5f;
    y = static_cast<float>(pass.lists.tile_y(tile) * kDeviceTile + row) + 0.5f;
    transmittance = inside(pass) ? 1.0f : 0.0f;
    nearest = pass.near_plane;
    if (inside(pass) && pass.near_limit != nullptr)
      nearest = max_of(nearest, pass.near_limit[index(pass)]);
  }
  GLINT_HD bool inside(const TilePass& pass) const {
    return x < static_cast<float>(pass.lists.width) && y < static_cast<float>(pass.lists.height);
  }
  GLINT_HD std::size_t index(const TilePass& pass) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(pass.lists.width) +
           static_cast<std::size_t>(x);
  }
  GLINT_HD bool live() const { return transmittance > 0; }
  // Whether the splat counts here, with a weight above 0, or stops the pixel.
  GLINT_HD bool composite(const Splat& splat, SplatHit<float>& hit) {
    return live() && composite_splat(splat, splat.map, x, y, nearest, transmittance, hit);
  }
};

// A batch of a tile's splats in shared memory.
struct SplatBatch {
  Splat splats[kTileThreads];
  std::uint32_t surfels[kTileThreads];
  std::uint32_t slots[kTileThreads];   // of the tile's first patch, were the splat there
  std::uint16_t across[kTileThreads];  // patches of the splat in a row
  std::uint8_t patches[kTileThreads];  // bit i: the box touches the tile's patch i

  GLINT_HD void load(const DeviceLists& lists, int tile, std::uint32_t pair, int k) {
    const std::uint32_t surfel = surfels[k] = lists.pairs[pair];
    splats[k] = lists.splats[surfel];
    const CellRect rect = patches_of(lists.boxes[surfel]);
    const int x = lists.tile_x(tile) * kPatchesAcross, y = lists.tile_y(tile) * kPatchesDown;
    unsigned mask = 0;
    for (int i = 0; i < kPatchesAcross * kPatchesDown; ++i) {
      const int px = x + i % kPatchesAcross, py = y + i / kPatchesAcross;
      const bool touches = rect.x0 <= px && px < rect.x1 && rect.y0 <= py && py < rect.y1;
      mask |= static_cast<unsigned>(touches) << i;
    }
    patches[k] = static_cast<std::uint8_t>(mask);
    across[k] = static_cast<std::uint16_t>(rect.across());
    // May lie in front of the surfel's first slot: whole numbers that wrap around.
    slots[k] = lists.first_slot(surfel) +
               static_cast<std::uint32_t>((y - rect.y0) * rect.across() + x - rect.x0);
  }
  GLINT_HD bool touches(int k, int patch) const { return (patches[k] >> patch & 1) != 0; }
  GLINT_HD std::uint32_t slot(int k, int patch) const {
    return slots[k] +
           static_cast<std::uint32_t>(patch / kPatchesAcross * across[k] + patch % kPatchesAcross);
  }
};

// f(warp, size of the batch) for all warps of a block and all batches of its tile's pairs `range`,
// front to back, while live(thread) holds for some thread. Returns the end of the last batch.
template <class Block, class Live, class F>
GLINT_HD std::uint32_t for_each_batch(
    Block& block, SplatBatch& shared, const DeviceLists& lists, PairRange range, Live&& live, F&& f
) {
  std::uint32_t first = range.begin;
  while (first < range.end && block.any(live)) {
    const std::uint32_t left = range.end - first;
    const int size = static_cast<int>(left < kTileThreads ? left : std::uint32_t{kTileThreads});
    block.each([&](int thread) {
      if (thread < size)
        shared.load(lists, block.index, first + static_cast<std::uint32_t>(thread), thread);
    });
    block.each_warp([&](auto& warp) { f(warp, size); });
    first += static_cast<std::uint32_t>(size);
  }
  return first;
}

template <class Warp, class T>
using PerLane = typename std::remove_reference_t<Warp>::template PerLane<T>;

// In device memory: images with the shapes of RasterOutput, null where there are none, and what the
// backward pass needs beside them.
using DeviceMaps = RasterMaps<PointerMap>;
using DeviceKept = KeptMaps<PointerMap>;

template <class Code>
struct ForwardTile {
  static constexpr int kThreads = kTileThreads;
  static constexpr int kBlocksAtOnce = 4;
  using Shared = SplatBatch;
  TilePass pass;
  DeviceMaps out;
  DeviceKept kept;
  DeviceSlots slots;
  std::uint32_t* ends;  // [tiles] of the pairs that were looked at

  template <class Block>
  GLINT_HD void operator()(Block& block, Shared& shared) const {
    typename Block::template PerThread<TilePixel> pixels;
    typename Block::template PerThread<PixelSums<float, Code>> sums;
    block.each([&](int thread) {
      pixels[thread].start(pass, block.index, thread);
      sums[thread].clear();
    });
    const auto live = [&](int thread) { return pixels[thread].live(); };
    const PairRange range = pass.lists.ranges[block.index];
    const auto composite = [&](auto& warp, int size) {
      for (int first = 0; first < size; first += kWarp) {
        if (warp.ballot([&](int lane) { return live(warp.thread(lane)); }) == 0) break;
        std::uint32_t near = warp.ballot([&](int lane) {
          return first + lane < size && shared.touches(first + lane, warp.index);
        });
        for (; near != 0; near &= near - 1)
          step(warp, shared, first + lowest_bit(near), pixels, sums);
      }
    };
    const std::uint32_t end = for_each_batch(block, shared, pass.lists, range, live, composite);
    block.each([&](int thread) {
      if (thread == 0) ends[block.index] = end;
      store(pixels[thread], sums[thread]);
    });
  }

 private:
  template <class Warp, class Pixels, class Sums>
  GLINT_HD void step(Warp& warp, const Shared& shared, int k, Pixels& pixels, Sums& sums) const {
    PerLane<Warp, float> weights;
    PerLane<Warp, bool> owns;
    const std::uint32_t seen = warp.ballot([&](int lane) {
      const int thread = warp.thread(lane);
      SplatHit<float> hit;
      weights[lane] = 0;
      owns[lane] = false;
      if (!pixels[thread].composite(shared.splats[k], hit)) return false;
      if (!hit.valid) return true;
      const float* feature = pass.feature(shared.surfels[k]);
      sums[thread].add(hit, shared.splats[k], feature, known(), pass.range);
      weights[lane] = hit.weight;
      owns[lane] = owns_pixel(hit);
      return true;
    });
    if (seen == 0) return;
    const std::uint32_t slot = shared.slot(k, warp.index);
    const float weight = warp.sum(weights);
    const std::uint32_t owners =
        known().statistics ? warp.ballot([&](int lane) { return owns[lane]; }) : 0;
    warp.each([&](int lane) {
      if (lane != 0) return;
      slots.visibility[slot] = weight > 0 ? weight : kStopsOnly;
      if (known().statistics) slots.owned[slot] = static_cast<std::uint8_t>(count_bits(owners));
    });
  }
  GLINT_HD MapChannels known() const { return Code::known(pass.has); }
  GLINT_HD void store(const TilePixel& pixel, PixelSums<float, Code>& sums) const {
    if (!pixel.inside(pass)) return;
    const std::size_t i = pixel.index(pass);
    sums.finish(abs_of(pixel.transmittance), pass.range);
    const auto store_map = [i](int width, const auto& values, float* map) {
      for_channels(values, width, [&](int c) { map[place(i, width, c)] = values[c]; });
    };
    for_each_map(
        known(),
        [&](const char*, int width, const auto& values, float* map) {
          store_map(width, values, map);
        },
        sums.maps,
        out
    );
    for_each_kept_map(
        known(),
        [&](int width, float, const auto& values, float* map) { store_map(width, values, map); },
        sums.kept,
        kept
    );
  }
};

template <class Code>
struct BackwardTile {
  static constexpr int kThreads = kTileThreads;
  static constexpr int kBlocksAtOnce = Code::kExtras || Code::kFeatures == 0 ? 2 : 3;
  static constexpr int kSums = Code::kUsedSums;
  static constexpr int kRows = (kSums + kWarp - 1) / kWarp;
  using Shared = SplatBatch;
  TilePass pass;
  DeviceMaps out, dL_dout;
  DeviceKept kept;
  const std::uint32_t* ends;    // of the forward pass
  const std::uint32_t* ranks;   // see DeviceSlots
  const PairCounts* first_row;  // of each surfel, in `rows`
  const PairTotals* totals;     // of rows
  float* rows;                  // [rows][kSums]

  template <class Block>
  GLINT_HD void operator()(Block& block, Shared& shared) const {
    if (totals->fit == 0) return;
    typename Block::template PerThread<TilePixel> pixels;
    typename Block::template PerThread<PixelGradient<float, Code>> states;
    block.each([&](int thread) {
      pixels[thread].start(pass, block.index, thread);
      if (pixels[thread].inside(pass)) start(pixels[thread].index(pass), states[thread]);
    });
    // Not while pixels are live: every row that the forward pass made is written, even where
    // rounding stops a pixel earlier than there.
    const PairRange range{pass.lists.ranges[block.index].begin, ends[block.index]};
    const auto always = [](int) { return true; };
    for_each_batch(block, shared, pass.lists, range, always, [&](auto& warp, int size) {
      PerLane<decltype(warp), std::uint32_t> row;
      for (int first = 0; first < size; first += kWarp) {
        std::uint32_t seen = warp.ballot([&](int lane) {
          row[lane] = first + lane < size ? row_of(shared, first + lane, warp.index) : kUnseen;
          return row[lane] != kUnseen;
        });
        for (; seen != 0; seen &= seen - 1) {
          const int k = lowest_bit(seen);
          step(warp, shared, first + k, warp.broadcast(row, k), pixels, states);
        }
      }
    });
  }

 private:
  GLINT_HD MapChannels known() const { return Code::known(pass.has); }
  GLINT_HD std::uint32_t row_of(const Shared& shared, int k, int patch) const {
    if (!shared.touches(k, patch)) return kUnseen;
    const std::uint32_t rank = ranks[shared.slot(k, patch)];
    return rank == kUnseen ? kUnseen : pairs_of(first_row[shared.surfels[k]]) + rank;
  }
  GLINT_HD void start(std::size_t i, PixelGradient<float, Code>& state) const {
    PixelMaps<float, Code> maps{};  // what the call has not: 0
    for_each_map(
        known(),
        [i](const char*, int width, auto& dL, auto& values, const float* dL_dmap, const float* map
        ) {
          for_channels(dL, width, [&](int c) {
            dL[c] = dL_dmap == nullptr ? 0.0f : dL_dmap[place(i, width, c)];
            values[c] = map[place(i, width, c)];
          });
        },
        state.dL,
        maps,
        dL_dout,
        out
    );
    for_each_kept_map(
        known(),
        [i](int width, float, auto& values, const float* map) {
          if (width > 0) values[0] = map[i];
        },
        state.kept,
        kept
    );
    state.start(maps, known());
  }
  template <class Warp, class Pixels, class States>
  GLINT_HD void step(
      Warp& warp, const Shared& shared, int k, std::uint32_t row, Pixels& pixels, States& states
  ) const {
    PerLane<Warp, Row<kSums>> sums;
    PerLane<Warp, Row<kRows>> totals_of_lane;
    warp.each([&](int lane) {
      sums[lane] = {};
      SplatHit<float> hit;
      const int thread = warp.thread(lane);
      if (!pixels[thread].composite(shared.splats[k], hit) || !hit.valid) return;
      const float* feature = pass.feature(shared.surfels[k]);
      states[thread].hit(hit, shared.splats[k], feature, known(), pass.range, sums[lane].v);
    });
    warp.template sums<kSums>(sums, totals_of_lane);
    float* to = rows + static_cast<std::size_t>(row) * kSums;
    warp.each([&](int lane) {
      for (int i = 0; i < kRows; ++i)
        if (i * kWarp + lane < kSums) to[i * kWarp + lane] = totals_of_lane[lane].v[i];
    });
  }
};

// What `use` makes of the hits of pixel i; they are not copied, for they are many.
template <class Use>
GLINT_HD auto with_surface_hits(const TilePass& pass, std::size_t i, const Use& use) {
  const DeviceLists& lists = pass.lists;
  const int x = static_cast<int>(i) % lists.width, y = static_cast<int>(i) / lists.width;
  const float* limit = pass.near_limit;
  SurfacePixel pixel(x, y, limit == nullptr ? pass.near_plane : max_of(pass.near_plane, limit[i]));
  const int across = tile_grid(lists.width, lists.height).across;
  const PairRange range = lists.ranges[y / kDeviceTile * across + x / kDeviceTile];
  for (std::uint32_t k = range.begin; k < range.end; ++k)
    if (!pixel.add(lists.splats[lists.pairs[k]])) break;
  return use(pixel.hits);
}

// Depth of the first surface of a pixel (first_surface.h).
struct FirstSurface {
  TilePass pass;
  DeviceMaps out;
  const float* mask;  // [H][W]
  FirstSurfaceSettings settings;
  float* depth;  // [H][W]

  GLINT_HD void operator()(std::size_t i) const {
    if (1 - out.alpha[i] > settings.max_transmittance)
      depth[i] = 0;
    else if (mask[i] > 0.5f)
      depth[i] = with_surface_hits(pass, i, [&](const SurfaceHits& hits) {
        return first_surface_depth(hits, settings);
      });
    else
      depth[i] = out.depth_median[i];
  }
};

// First and last mode of a pixel's depth (depth_modes.h).
struct DepthModesOfPixel {
  TilePass pass;
  DepthModeSettings settings;
  float *first, *last;  // [H][W]

  GLINT_HD void operator()(std::size_t i) const {
    const DepthModes modes = with_surface_hits(pass, i, [&](const SurfaceHits& hits) {
      return ModeSearch(hits, settings).run();
    });
    first[i] = modes.first;
    last[i] = modes.last;
  }
};

}  // namespace glint::gpu
