// SPDX-License-Identifier: MIT
// Rasterisation on the GPU, as bodies (block.h): surfels projected to splats, listed per tile, and
// one thread a pixel through its tile's list. Formulas: project.h, splat_hit.h, pixel_pass.h.
#pragma once

#include "glint/cuda/block.h"
#include "glint/render/pixel_pass.h"
#include "glint/render/surface_pixel.h"

namespace glint::gpu {

inline constexpr int kDeviceTile = 16;  // pixels
inline constexpr int kTileThreads = kDeviceTile * kDeviceTile;

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

// Tiles [x0, x1) x [y0, y1) of a box.
struct TileRect {
  int x0, x1, y0, y1;
  GLINT_HD std::uint32_t count() const { return static_cast<std::uint32_t>((x1 - x0) * (y1 - y0)); }
};
GLINT_HD TileRect tile_rect(const PixelBox& box) {
  if (box.empty()) return {0, 0, 0, 0};
  return {
      box.x_min / kDeviceTile,
      (box.x_max + kDeviceTile - 1) / kDeviceTile,
      box.y_min / kDeviceTile,
      (box.y_max + kDeviceTile - 1) / kDeviceTile};
}

struct ProjectSurfels {
  DeviceSurfels surfels;
  CameraOf<float> camera;
  Splat* splats;
  PixelBox* boxes;
  std::uint32_t* num_tiles;

  GLINT_HD void operator()(std::size_t i) const {
    const float opacity = surfels.opacities[i];
    const ProjectedSurfel<float> p =
        project_surfel(geometry_at(surfels, i), camera, max_rho_of(opacity));
    splats[i] = splat_of(p, opacity);
    boxes[i] = pixel_box(p.box_min_x, p.box_max_x, p.box_min_y, p.box_max_y, camera);
    num_tiles[i] = tile_rect(boxes[i]).count();
  }
};

// Order of floats as unsigned integers.
GLINT_HD std::uint32_t ordered_bits(float v) {
  std::uint32_t bits;
  memcpy(&bits, &v, sizeof bits);
  return bits >> 31 != 0 ? ~bits : bits | 0x80000000u;
}

// Keys are (tile, depth of the centre); pairs are written surfel by surfel, so that a stable sort
// leaves ties in the order of the surfels.
struct WritePairs {
  const Splat* splats;
  const PixelBox* boxes;
  const std::uint32_t* first_pair;
  TileGrid grid;
  std::uint64_t* keys;
  std::uint32_t* surfels;

  GLINT_HD void operator()(std::size_t i) const {
    const TileRect rect = tile_rect(boxes[i]);
    std::uint32_t pair = first_pair[i];
    for (int y = rect.y0; y < rect.y1; ++y)
      for (int x = rect.x0; x < rect.x1; ++x, ++pair) {
        const auto tile = static_cast<std::uint64_t>(y * grid.across + x);
        keys[pair] = tile << 32 | ordered_bits(splats[i].z_center);
        surfels[pair] = static_cast<std::uint32_t>(i);
      }
  }
};

struct PairRange {
  std::uint32_t begin = 0, end = 0;
};
// Ranges of tiles without pairs stay as they were: empty.
struct FindTileRanges {
  const std::uint64_t* keys;
  std::size_t num_pairs;
  PairRange* ranges;

  GLINT_HD void operator()(std::size_t i) const {
    const std::uint64_t tile = keys[i] >> 32;
    if (i == 0 || keys[i - 1] >> 32 != tile) ranges[tile].begin = static_cast<std::uint32_t>(i);
    if (i + 1 == num_pairs || keys[i + 1] >> 32 != tile)
      ranges[tile].end = static_cast<std::uint32_t>(i + 1);
  }
};

// Per surfel, shapes of RasterOutput; null where a call has them not.
struct DeviceSeen {
  float* visibility;
  std::uint8_t* in_view;  // 1: reached at least one tile
  float *owned_pixels, *radii;
};

struct ResetSeen {
  const std::uint32_t* num_tiles;
  DeviceSeen out;

  GLINT_HD void operator()(std::size_t i) const {
    out.visibility[i] = 0;
    out.in_view[i] = num_tiles[i] > 0 ? 1 : 0;
    if (out.owned_pixels != nullptr) out.owned_pixels[i] = 0;
  }
};

struct ScreenRadii {
  DeviceSurfels surfels;
  CameraOf<float> camera;
  const std::uint32_t* num_tiles;
  float* radii;

  GLINT_HD void operator()(std::size_t i) const {
    const float max_rho = max_rho_of(surfels.opacities[i]);
    radii[i] = num_tiles[i] > 0 ? screen_radius(geometry_at(surfels, i), camera, max_rho) : 0.0f;
  }
};

// What both passes over a tile read.
struct TilePass {
  const Splat* splats;
  const float* features;  // [N][C]
  const std::uint32_t* pairs;
  const PairRange* ranges;
  const float* near_limit;  // [H][W] or null
  float near_plane;
  int width, height;
  MapChannels has;
  DistortionRange range;

  GLINT_HD const float* feature(std::uint32_t surfel) const {
    return features + static_cast<std::size_t>(surfel) * static_cast<std::size_t>(has.features);
  }
  GLINT_HD int tile_x(int tile) const { return tile % tile_grid(width, height).across; }
  GLINT_HD int tile_y(int tile) const { return tile / tile_grid(width, height).across; }
};

// Of a channel of pixel i in a map of so many.
GLINT_HD std::size_t place(std::size_t i, int channels, int channel) {
  return i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(channel);
}

// A pixel while its tile is traversed.
struct TilePixel {
  int x, y;
  bool inside;
  float nearest, transmittance;  // negative once stopped; 0 outside the image

  GLINT_HD void start(const TilePass& pass, int tile, int thread) {
    x = pass.tile_x(tile) * kDeviceTile + thread % kDeviceTile;
    y = pass.tile_y(tile) * kDeviceTile + thread / kDeviceTile;
    inside = x < pass.width && y < pass.height;
    transmittance = inside ? 1.0f : 0.0f;
    nearest = pass.near_plane;
    if (inside && pass.near_limit != nullptr)
      nearest = max_of(nearest, pass.near_limit[index(pass)]);
  }
  GLINT_HD std::size_t index(const TilePass& pass) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(pass.width) +
           static_cast<std::size_t>(x);
  }
  GLINT_HD bool live() const { return transmittance > 0; }
  // Whether the splat counts here.
  GLINT_HD bool composite(const Splat& splat, SplatHit<float>& hit) {
    const bool counts = composite_splat(
        splat,
        splat.map,
        static_cast<float>(x) + 0.5f,
        static_cast<float>(y) + 0.5f,
        nearest,
        transmittance,
        hit
    );
    return counts && hit.weight > 0;
  }
};

// A batch of a tile's splats in shared memory.
struct SplatBatch {
  std::uint32_t surfels[kTileThreads];
  Splat splats[kTileThreads];

  GLINT_HD void load(const TilePass& pass, std::uint32_t first, std::uint32_t end, int thread) {
    const std::uint32_t pair = first + static_cast<std::uint32_t>(thread);
    if (pair >= end) return;
    surfels[thread] = pass.pairs[pair];
    splats[thread] = pass.splats[surfels[thread]];
  }
};
GLINT_HD int batch_size(std::uint32_t first, std::uint32_t end) {
  const std::uint32_t left = end - first;
  return static_cast<int>(left < kTileThreads ? left : std::uint32_t{kTileThreads});
}

// In device memory: images with the shapes of RasterOutput, null where there are none, and what the
// backward pass needs beside them.
using DeviceMaps = RasterMaps<PointerMap>;
using DeviceKept = KeptMaps<PointerMap>;

// f(thread, float out[kN]) for every thread, out zero before; where it returns true for some thread
// of a warp, p[i] += the warp's sum of out[i].
template <int kN, class Block, class F>
GLINT_HD void add_over_warps(Block& block, F&& f, float* p) {
  block.each_warp([&](auto& warp) {
    using Warp = std::remove_reference_t<decltype(warp)>;
    typename Warp::template PerLane<Row<kN>> out{};
    typename Warp::template PerLane<Row<(kN + kWarp - 1) / kWarp>> totals{};
    if (warp.ballot([&](int lane) { return f(warp.thread(lane), out[lane].v); }) == 0) return;
    warp.template sums<kN>(out, totals);
    warp.each([&](int lane) {
      for (int i = lane; i < kN; i += kWarp) block.add(p + i, totals[lane].v[i / kWarp]);
    });
  });
}

template <class Code>
struct ForwardTile {
  static constexpr int kThreads = kTileThreads;
  using Shared = SplatBatch;
  TilePass pass;
  DeviceMaps out;
  DeviceKept kept;
  float *visibility, *owned_pixels;  // [N]

  template <class Block>
  GLINT_HD void operator()(Block& block, Shared& shared) const {
    typename Block::template PerThread<TilePixel> pixels;
    typename Block::template PerThread<PixelSums<float, Code>> sums;
    block.each([&](int thread) {
      pixels[thread].start(pass, block.index, thread);
      sums[thread].clear();
    });
    const PairRange range = pass.ranges[block.index];
    for (std::uint32_t first = range.begin; first < range.end; first += kTileThreads) {
      if (!block.any([&](int thread) { return pixels[thread].live(); })) break;
      block.each([&](int thread) { shared.load(pass, first, range.end, thread); });
      const int size = batch_size(first, range.end);
      for (int k = 0; k < size; ++k)
        add_over_warps<1>(
            block,
            [&](int thread, float* weight) {
              return step(block, shared, k, pixels[thread], sums[thread], *weight);
            },
            visibility + shared.surfels[k]
        );
      block.each([](int) {});
    }
    block.each([&](int thread) { store(pixels[thread], sums[thread]); });
  }

 private:
  template <class Block>
  GLINT_HD bool step(
      Block& block,
      const Shared& shared,
      int k,
      TilePixel& pixel,
      PixelSums<float, Code>& sums,
      float& weight
  ) const {
    SplatHit<float> hit;
    if (!pixel.live() || !pixel.composite(shared.splats[k], hit)) return false;
    const float* feature = pass.feature(shared.surfels[k]);
    sums.add(hit, shared.splats[k], feature, known(), pass.range);
    // Whole numbers: the same in every order.
    if (known().statistics && owns_pixel(hit)) block.add(owned_pixels + shared.surfels[k], 1.0f);
    weight = hit.weight;
    return true;
  }
  GLINT_HD MapChannels known() const { return Code::known(pass.has); }
  GLINT_HD void store(const TilePixel& pixel, PixelSums<float, Code>& sums) const {
    if (!pixel.inside) return;
    const std::size_t i = pixel.index(pass);
    sums.finish(abs_of(pixel.transmittance), pass.range);
    const auto store_map = [i](int width, const float* values, float* map) {
      for (int c = 0; c < width; ++c) map[place(i, width, c)] = values[c];
    };
    for_each_map(
        known(),
        [&](const char*, int width, const float* values, float* map) {
          store_map(width, values, map);
        },
        sums.maps,
        out
    );
    for_each_kept_map(
        known(),
        [&](int width, float, const float* values, float* map) { store_map(width, values, map); },
        sums.kept,
        kept
    );
  }
};

template <class Code>
struct BackwardTile {
  static constexpr int kThreads = kTileThreads;
  static constexpr int kSums = Code::kSums;
  using Shared = SplatBatch;
  TilePass pass;
  DeviceMaps out, dL_dout;
  DeviceKept kept;
  float* gradients;  // [N][kSums]

  template <class Block>
  GLINT_HD void operator()(Block& block, Shared& shared) const {
    typename Block::template PerThread<TilePixel> pixels;
    typename Block::template PerThread<PixelGradient<float, Code>> states;
    block.each([&](int thread) {
      pixels[thread].start(pass, block.index, thread);
      if (pixels[thread].inside) start(pixels[thread].index(pass), states[thread]);
    });
    const PairRange range = pass.ranges[block.index];
    for (std::uint32_t first = range.begin; first < range.end; first += kTileThreads) {
      if (!block.any([&](int thread) { return pixels[thread].live(); })) break;
      block.each([&](int thread) { shared.load(pass, first, range.end, thread); });
      const int size = batch_size(first, range.end);
      for (int k = 0; k < size; ++k)
        add_over_warps<kSums>(
            block,
            [&](int thread, float* sums) {
              return step(shared, k, pixels[thread], states[thread], sums);
            },
            gradients + static_cast<std::size_t>(shared.surfels[k]) * kSums
        );
      block.each([](int) {});
    }
  }

 private:
  GLINT_HD MapChannels known() const { return Code::known(pass.has); }
  GLINT_HD void start(std::size_t i, PixelGradient<float, Code>& state) const {
    PixelMaps<float, Code> maps{};  // what the call has not: 0
    for_each_map(
        known(),
        [i](const char*, int width, float* dL, float* values, const float* dL_dmap, const float* map
        ) {
          for (int c = 0; c < width; ++c) {
            dL[c] = dL_dmap == nullptr ? 0.0f : dL_dmap[place(i, width, c)];
            values[c] = map[place(i, width, c)];
          }
        },
        state.dL,
        maps,
        dL_dout,
        out
    );
    for_each_kept_map(
        known(),
        [i](int width, float, float* values, const float* map) {
          if (width > 0) *values = map[i];
        },
        state.kept,
        kept
    );
    state.start(maps, known());
  }
  GLINT_HD bool step(
      const Shared& shared, int k, TilePixel& pixel, PixelGradient<float, Code>& state, float* sums
  ) const {
    SplatHit<float> hit;
    if (!pixel.live() || !pixel.composite(shared.splats[k], hit)) return false;
    const float* feature = pass.feature(shared.surfels[k]);
    state.hit(hit, shared.splats[k], feature, known(), pass.range, sums);
    return true;
  }
};

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
    else
      depth[i] = mask[i] > 0.5f ? behind_mask(i) : out.depth_median[i];
  }

 private:
  GLINT_HD float behind_mask(std::size_t i) const {
    const int x = static_cast<int>(i) % pass.width, y = static_cast<int>(i) / pass.width;
    const float* limit = pass.near_limit;
    SurfacePixel pixel(
        x, y, limit == nullptr ? pass.near_plane : max_of(pass.near_plane, limit[i])
    );
    const int across = tile_grid(pass.width, pass.height).across;
    const PairRange range = pass.ranges[y / kDeviceTile * across + x / kDeviceTile];
    for (std::uint32_t k = range.begin; k < range.end; ++k)
      if (!pixel.add(pass.splats[pass.pairs[k]])) break;
    return first_surface_depth(pixel.hits, settings);
  }
};

// dL/d(parameters), shapes of RasterGradient.
struct DeviceGradients {
  float *means, *scales, *rotations, *opacities, *features, *screen;
  float* screen_abs;  // null: not asked for
};

// From the sums over a surfel's pixels back to its parameters.
struct SurfelVjp {
  DeviceSurfels surfels;
  CameraOf<float> camera;
  const Splat* splats;
  const std::uint32_t* num_tiles;
  const float* sums;  // [N][stride]
  int stride;
  MapChannels has;
  DeviceGradients out;

  GLINT_HD void operator()(std::size_t i) const {
    const float* s = sums + i * static_cast<std::size_t>(stride);
    const bool seen = num_tiles[i] > 0;
    const ProjectedSurfel<float> g =
        projected_gradient<float>(has, [s](int slot) { return s[slot]; });
    SurfelGeometry<float> dL_dsurfel{};
    Vec3f dL_dm{};
    // Surfels without pairs get exact zeros, whatever their parameters (they may not be finite).
    if (seen) project_surfel_vjp(geometry_at(surfels, i), camera, g, dL_dsurfel, dL_dm);
    store(i, s, dL_dsurfel, screen_gradient(dL_dm, seen ? splats[i].z_center : 1.0f, camera));
  }

 private:
  GLINT_HD void store(std::size_t i, const float* s, const SurfelGeometry<float>& g, Vec2f screen)
      const {
    for (int k = 0; k < 3; ++k) out.means[3 * i + static_cast<std::size_t>(k)] = g.mean[k];
    out.scales[2 * i] = g.scale.x;
    out.scales[2 * i + 1] = g.scale.y;
    const float rotation[4] = {g.rotation.w, g.rotation.x, g.rotation.y, g.rotation.z};
    for (std::size_t k = 0; k < 4; ++k) out.rotations[4 * i + k] = rotation[k];
    out.opacities[i] = s[kSumOpacity];
    const auto channels = static_cast<std::size_t>(surfels.channels);
    for (std::size_t c = 0; c < channels; ++c) out.features[channels * i + c] = s[kSumFeatures + c];
    out.screen[2 * i] = screen.x;
    out.screen[2 * i + 1] = screen.y;
    if (out.screen_abs == nullptr) return;
    const float* pixels = s + extra_slot(surfels.channels, kSumScreenAbsX);
    out.screen_abs[2 * i] = 0.5f * camera.width * pixels[0];
    out.screen_abs[2 * i + 1] = 0.5f * camera.height * pixels[1];
  }
};

}  // namespace glint::gpu
