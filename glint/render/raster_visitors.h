// SPDX-License-Identifier: MIT
// CPU rasterisation: what a tile's forward and backward pass do with its hits, and what they keep.
// T: Float16 or Float8 (a group of a tile's pixels) or float. All widths but float give the same
// bytes: a group of sixteen is two of eight, whose sums are added at the end.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "glint/render/tile_kernel.h"

namespace glint {

// What backward needs of forward; reused between calls.
struct RasterSaved {
  std::shared_ptr<const TileLists> shared_lists;  // those of this pass or of the first of several
  const TileLists& lists() const { return *shared_lists; }
  KeptMaps<ImageMap> kept;
  // Of each pair, in the order of TileLists::entries.
  std::vector<float> pair_visibility;
  std::vector<float> pair_owned;  // pixels of the tile that the surfel owns, or empty
  // Blocks of the tile where a pixel has a hit, one bit each: backward looks at no others.
  std::vector<std::uint8_t> pair_blocks;
  std::vector<float> pair_gradients;  // [pairs][slot_width]

  // Calls f(place) for the pairs of a surfel.
  template <class F>
  void for_pairs(std::size_t surfel, F&& f) const {
    for (std::uint32_t pair = lists().pair_begin[surfel]; pair < lists().pair_begin[surfel + 1];
         ++pair)
      f(lists().places[pair]);
  }
};

// ---- forward -----------------------------------------------------------------------------------

template <class T, class Code>
struct ForwardVisitor {
  const TileContext& tile;
  const DistortionRange range;
  RasterSaved& saved;
  PixelSums<T, Code> sums[kGroupsPerTile<T>];
  T visibility[kHalves<T>], owned[kHalves<T>];
  unsigned blocks;
  const float* feature;
  const Splat* splat;

  ForwardVisitor(const TileContext& tile, RasterSaved& saved)
      : tile(tile), range(distortion_range(tile.call.settings)), saved(saved) {
    for (auto& group : sums) group.clear();
  }

  MapChannels has() const { return Code::known(tile.has); }
  std::uint64_t groups(std::uint32_t place) const {
    return groups_of_blocks<T>(blocks_of(tile, tile.lists.boxes[tile.lists.entries[place]]));
  }
  void begin(std::uint32_t surfel) {
    std::fill_n(visibility, kHalves<T>, T(0));
    std::fill_n(owned, kHalves<T>, T(0));
    blocks = 0;
    feature = tile.feature(surfel);
    splat = &tile.lists.splats[surfel];
  }
  SplatHit<T> room_for_hit() const {  // of its own, in registers
    SplatHit<T> hit;
    return hit;
  }
  void hit(int g, const SplatHit<T>& hit) {
    visibility[half_of<T>(g)] += hit.weight;
    const bool counts = any(hit.transmittance_behind < hit.transmittance);  // or stops a pixel
    blocks |= static_cast<unsigned>(counts) << block_of<T>(g);
    if (has().statistics) owned[half_of<T>(g)] += keep(owns_pixel(hit), T(1));
    sums[g].add(hit, *splat, feature, has(), range);
  }
  void end(std::uint32_t place) {
    saved.pair_visibility[place] = tile_sum<T>(visibility);
    if (has().statistics) saved.pair_owned[place] = tile_sum<T>(owned);
    saved.pair_blocks[place] = static_cast<std::uint8_t>(blocks);
  }
  void skip(std::uint32_t place) {
    saved.pair_visibility[place] = 0;
    if (has().statistics) saved.pair_owned[place] = 0;
    saved.pair_blocks[place] = 0;
  }

  void store(const TilePixels<T>& pixels, RasterOutput& out) {
    for (int g = 0; g < kGroupsPerTile<T>; ++g) {
      sums[g].finish(pixels.final_transmittance(g), range);
      const auto store_map = [&](int width, const T* values, Image& map) {
        if (width > 0) store_pixels(tile, map.ref(), g, width, values);
      };
      for_each_map(
          has(),
          [&](const char*, int width, const T* values, Image& map) {
            store_map(width, values, map);
          },
          sums[g].maps,
          out
      );
      for_each_kept_map(
          has(),
          [&](int width, float, const T* values, Image& map) { store_map(width, values, map); },
          sums[g].kept,
          saved.kept
      );
    }
  }
};

template <class T, class Code>
void forward_tile(const TileContext& tile, RasterSaved& saved, RasterOutput& out) {
  TilePixels<T> pixels(tile);
  ForwardVisitor<T, Code> visitor(tile, saved);
  for_each_hit(tile, pixels, visitor);
  visitor.store(pixels, out);
}

// ---- backward ----------------------------------------------------------------------------------

template <class T, class Code>
struct BackwardVisitor {
  const TileContext& tile;
  const DistortionRange range;
  RasterSaved& saved;
  PixelGradient<T, Code> pixels[kGroupsPerTile<T>];

  BackwardVisitor(
      const TileContext& tile,
      RasterSaved& saved,
      const RasterOutput& out,
      const RasterOutputGradient& dL_dout
  )
      : tile(tile), range(distortion_range(tile.call.settings)), saved(saved) {
    for (int g = 0; g < kGroupsPerTile<T>; ++g) load_group(g, out, dL_dout);
  }

  void load(const Image& map, int group, int width, float outside, T* values) const {
    if (map.empty())
      std::fill_n(values, width, T(0));
    else if (width > 0)
      load_pixels(tile, map.view(), group, width, outside, values);
  }
  void load_group(int g, const RasterOutput& out, const RasterOutputGradient& dL_dout) {
    PixelMaps<T, Code> maps;
    for_each_map(
        has(),
        [&](const char*, int width, T* dL, T* values, const Image& dL_dmap, const Image& map) {
          load(dL_dmap, g, width, 0.0f, dL);
          load(map, g, width, 0.0f, values);
        },
        pixels[g].dL,
        maps,
        dL_dout,
        out
    );
    for_each_kept_map(
        has(),
        [&](int width, float empty, T* values, const Image& map) {
          load(map, g, width, empty, values);
        },
        pixels[g].kept,
        saved.kept
    );
    pixels[g].start(maps, has());
  }

  MapChannels has() const { return Code::known(tile.has); }
  std::uint64_t groups(std::uint32_t place) const {
    return groups_of_blocks<T>(saved.pair_blocks[place]);
  }
  // Hits wait until there are some, and are then worked on step by step: a step of one hit does not
  // wait for that of another, as all steps of one do.
  void begin(std::uint32_t) {}
  SplatHit<T>& room_for_hit() { return hits[num_hits]; }
  void hit(int g, const SplatHit<T>&) { groups_of_hits[num_hits++] = g; }
  void skip(std::uint32_t) {}  // sum_pairs() leaves out pairs without blocks
  void end(std::uint32_t place) {
    places[num_places] = place;
    ends[num_places++] = num_hits;
    if (num_hits > kRoom - kGroupsPerTile<T>) finish();
  }
  // What waits.
  void finish() {
    for_waiting([&](std::uint32_t place, int begin, int end) { go_through(place, begin, end); });
    for_waiting([&](std::uint32_t place, int begin, int end) { sum_up(place, begin, end); });
    num_hits = num_places = 0;
  }

 private:
  using Gradient = PixelGradient<T, Code>;

  // Calls f(place, its first hit, one past its last).
  template <class F>
  void for_waiting(F&& f) const {
    for (int p = 0; p < num_places; ++p) f(places[p], p == 0 ? 0 : ends[p - 1], ends[p]);
  }
  const Splat& splat_of(std::uint32_t place) const {
    return tile.lists.splats[tile.lists.entries[place]];
  }
  void go_through(std::uint32_t place, int begin, int end) {
    const Splat& splat = splat_of(place);
    const float* feature = tile.feature(tile.lists.entries[place]);
    for (int i = begin; i < end; ++i)
      gradients[i] = pixels[groups_of_hits[i]].through(hits[i], splat, feature, has(), range);
  }
  void sum_up(std::uint32_t place, int begin, int end) {
    T sums[kHalves<T>][Code::kSums];
    for (int half = 0; half < kHalves<T>; ++half) {
      int to = kHalves<T> == 1 ? end : begin;
      while (to < end && half_of<T>(groups_of_hits[to]) == half) ++to;
      sum_hits(splat_of(place), begin, to, sums[half]);
      begin = to;
    }
    store(place, &sums[0][0]);
  }
  void sum_hits(const Splat& splat, int begin, int end, T* sums) const {
    std::fill_n(sums, splat_sums(has()), T(0));
    // A loop for each: with a surface a little faster than one (docs/design/tried.md).
    for (int i = begin; i < end; ++i)
      pixels[groups_of_hits[i]].add_attributes(hits[i], splat, has(), sums);
    for (int i = begin; i < end; ++i)
      Gradient::add_alpha(hits[i], gradients[i], splat, has(), sums);
    for (int i = begin; i < end; ++i) Gradient::add_geometry(hits[i], gradients[i], splat, sums);
  }
  // sums: [halves][Code::kSums]
  void store(std::uint32_t place, const T* sums) {
    const int width = splat_sums(has());
    float* slot = &saved.pair_gradients[place * static_cast<std::size_t>(width)];
    if constexpr (kLanesOf<T> == 1) {
      std::copy_n(sums, width, slot);
    } else {
      for (int i = 0; i < width; i += 8) {
        Float8 eight[8];
        for (int k = 0; k < 8; ++k) eight[k] = both_halves(&sums[i + k], Code::kSums);
        lane_sums(eight).store(slot + i);
      }
    }
  }

  static constexpr int kRoom = 2 * kGroupsPerTile<T>;
  int num_hits = 0, num_places = 0;  // that wait
  SplatHit<T> hits[kRoom];
  HitGradient<T> gradients[kRoom];
  int groups_of_hits[kRoom];
  std::uint32_t places[kRoom];
  int ends[kRoom];  // of the hits of each place
};

template <class T, class Code>
void backward_tile(
    const TileContext& tile,
    RasterSaved& saved,
    const RasterOutput& out,
    const RasterOutputGradient& dL_dout
) {
  TilePixels<T> pixels(tile);
  BackwardVisitor<T, Code> visitor(tile, saved, out, dL_dout);
  for_each_hit(tile, pixels, visitor);
  visitor.finish();
}

}  // namespace glint
