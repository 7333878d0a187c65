// SPDX-License-Identifier: MIT
// CPU rasterisation, second half: the loop over one tile's hits. Forward and backward run the same
// traversal with different visitors, so they cannot drift. T: Float8 (a row of a tile) or float.
#pragma once

#include "glint/core/simd.h"
#include "glint/render/raster_tiles.h"

namespace glint {

inline constexpr int kMaxChannels = 16;

// A tile's pixels as kTileSize rows of kGroups vectors.
template <class T>
inline constexpr int kGroups = kTileSize / kLanesOf<T>;
template <class T>
inline constexpr int kGroupsPerTile = kTileSize* kGroups<T>;

struct TileContext {
  const RasterInput& input;
  const TileLists& lists;
  ImageSize size;
  float near_plane;
  int tile_x, tile_y;

  int x0() const { return tile_x * kTileSize; }
  int y0() const { return tile_y * kTileSize; }
  std::uint32_t list_begin() const { return lists.tile_begin[tile_y * lists.tiles_x + tile_x]; }
  std::uint32_t list_end() const { return lists.tile_begin[tile_y * lists.tiles_x + tile_x + 1]; }
};

// Pixels of one tile, gathered from and scattered to image rows; lanes outside the image get
// `fill`.
template <class T>
T load_pixels(const TileContext& tile, const ImageView& image, int group, int channel, float fill) {
  alignas(32) float lanes[kLanesOf<T>];
  const int y = tile.y0() + group / kGroups<T>, x = tile.x0() + group % kGroups<T> * kLanesOf<T>;
  for (int i = 0; i < kLanesOf<T>; ++i)
    lanes[i] = x + i < image.width && y < image.height ? image.at(x + i, y, channel) : fill;
  return load_lanes<T>(lanes);
}
template <class T>
void store_pixels(const TileContext& tile, Image& image, int group, int channel, T value) {
  alignas(32) float lanes[kLanesOf<T>];
  store_lanes(lanes, value);
  const int y = tile.y0() + group / kGroups<T>, x = tile.x0() + group % kGroups<T> * kLanesOf<T>;
  for (int i = 0; i < kLanesOf<T> && x + i < image.width() && y < image.height(); ++i)
    image.at(x + i, y, channel) = lanes[i];
}

// Transmittance of the pixels while the tile is traversed. A pixel that stops gets working
// transmittance 0, which makes every later weight 0, and keeps its last value aside.
template <class T>
struct TileTransmittance {
  T working[kGroupsPerTile<T>];
  T stopped[kGroupsPerTile<T>];
  T nearest[kGroupsPerTile<T>];  // only hits behind this depth count
  bool live[kGroupsPerTile<T>];
  int num_live = 0;

  explicit TileTransmittance(const TileContext& tile) {
    for (int g = 0; g < kGroupsPerTile<T>; ++g) {
      const int y = tile.y0() + g / kGroups<T>, x = tile.x0() + g % kGroups<T> * kLanesOf<T>;
      const T column = T(static_cast<float>(x)) + lane_indices<T>();
      const auto inside = (column < T(static_cast<float>(tile.size.width))) &
                          (T(static_cast<float>(y)) < T(static_cast<float>(tile.size.height)));
      working[g] = select(inside, T(1), T(0));
      stopped[g] = T(1);
      nearest[g] = T(tile.near_plane);
      if (!tile.input.near_limit.empty())
        nearest[g] = max_of(nearest[g], load_pixels<T>(tile, tile.input.near_limit, g, 0, 0.0f));
      live[g] = any(inside);
      num_live += live[g];
    }
  }
  T final_value(int g) const { return select(working[g] > T(0), working[g], stopped[g]); }
  void stop(int g, Mask<T> stopping) {
    stopped[g] = select(stopping, working[g], stopped[g]);
    working[g] = select(stopping, T(0), working[g]);
    if (any(working[g] > T(0))) return;
    live[g] = false;
    --num_live;
  }
};

// One surfel at the pixels of one group. Lanes outside `valid` hold harmless values.
template <class T>
struct TileHit {
  Mask<T> valid;
  Mask<T> in_plane;  // rho comes from the surfel's plane; otherwise from the low-pass
  T x, y;            // offsets from the splat's reference point, pixels
  Vec3<T> zeta;
  T rho, depth;
  SplatAlpha<T> alpha;
  T transmittance;  // before the hit
  T weight;         // 0 outside `valid`
};

// rho and depth of a splat at a pixel. In the low-pass branch the ray misses the surfel by more
// than the pixel's filter: depth is the centre's (Deviation from the official kernels' latest
// state, as in EnvGS: the plane's depth there can be arbitrarily far from the surfel).
template <class T>
void geometry_of_hit(const Splat& s, const PixelPlaneMap<T>& map, TileHit<T>& hit) {
  hit.zeta = zeta_at(map, hit.x, hit.y);
  const PlaneHit<T> plane = intersect(hit.zeta, map.det);
  const T rho3 = fma_of(plane.u, plane.u, plane.v * plane.v);
  const T rho2 = low_pass_rho2(hit.x - T(s.center_x), hit.y - T(s.center_y));
  hit.in_plane = rho3 <= rho2;  // false for NaN
  hit.rho = select(hit.in_plane, rho3, rho2);
  hit.depth = select(hit.in_plane, plane.t, T(s.z_center));
}

template <class T>
PixelPlaneMap<T> broadcast_map(const PixelPlaneMap<float>& m) {
  const auto lift = [](Vec3f v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
  return {lift(m.gx), lift(m.gy), lift(m.g0), T(m.det)};
}

// The hit of one splat at one group, composited; calls visitor.hit() when any lane counts.
template <class T, class Visitor>
void visit_group(
    const Splat& splat,
    const PixelPlaneMap<T>& map,
    int g,
    TileTransmittance<T>& t,
    TileHit<T>& hit,
    Visitor& visitor
) {
  geometry_of_hit(splat, map, hit);
  hit.valid = (hit.rho <= T(kMaxRho)) & (hit.depth > t.nearest[g]);
  if (!any(hit.valid)) return;
  hit.alpha = splat_alpha(T(splat.opacity), hit.rho);
  hit.transmittance = t.working[g];
  const BlendStep<T> step = blend_step(hit.transmittance, hit.alpha.alpha);
  hit.valid = hit.valid & (hit.alpha.alpha >= T(kMinAlpha)) & (hit.transmittance > T(0));
  const auto enough = step.transmittance >= T(kMinTransmittance);
  const auto stopping = hit.valid & !enough;
  if (any(stopping)) t.stop(g, stopping);
  hit.valid = hit.valid & enough;
  if (!any(hit.valid)) return;
  hit.weight = select(hit.valid, step.weight, T(0));
  hit.depth = select(hit.valid, hit.depth, T(0));
  visitor.hit(g, hit);
  t.working[g] = select(hit.valid, step.transmittance, t.working[g]);
}

// All hits of a tile, front to back. Visitor: begin(position, surfel), hit(group, hit),
// end(surfel).
template <class T, class Visitor>
void for_each_hit(const TileContext& tile, TileTransmittance<T>& t, Visitor& visitor) {
  const std::uint32_t begin = tile.list_begin(), end = tile.list_end();
  for (std::uint32_t k = begin; k < end; ++k) {
    const std::uint32_t surfel = tile.lists.surfel_ids[k];
    visitor.begin(k - begin, surfel);
    if (t.num_live > 0) {
      const Splat& splat = tile.lists.splats[surfel];
      const PixelBox& box = tile.lists.boxes[surfel];
      const PixelPlaneMap<T> map = broadcast_map<T>(splat.map);
      const int row_end = std::min(kTileSize, box.y_max - tile.y0());
      for (int row = std::max(0, box.y_min - tile.y0()); row < row_end; ++row)
        for (int i = 0; i < kGroups<T>; ++i) {
          const int g = row * kGroups<T> + i;
          if (!t.live[g]) continue;
          TileHit<T> hit;
          hit.x = T(static_cast<float>(tile.x0() + i * kLanesOf<T>) + 0.5f - splat.x_ref) +
                  lane_indices<T>();
          hit.y = T(static_cast<float>(tile.y0() + row) + 0.5f - splat.y_ref);
          visit_group(splat, map, g, t, hit, visitor);
        }
    }
    visitor.end(surfel);
  }
}

}  // namespace glint
