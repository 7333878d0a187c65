// SPDX-License-Identifier: MIT
#include "glint/render/raster_tiles.h"

#include <algorithm>
#include <cmath>

#include "glint/core/parallel.h"
#include "glint/core/simd.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 1024;  // surfels a block
constexpr int kBands = 8;             // bands of tile rows listed in parallel

// Squared radius where alpha falls below 1/255, at most 3 sigma; not positive: never visible.
float max_rho_of(float opacity) {
  return std::min(kMaxRho, 2.0f * std::log(std::max(opacity, 1e-12f) / kMinAlpha) + 1e-4f);
}

float lane(float v, int) { return v; }
float lane(Float8 v, int i) { return v[i]; }
template <class T>
Vec3f lane(Vec3<T> v, int i) {
  return {lane(v.x, i), lane(v.y, i), lane(v.z, i)};
}

template <class T>
Splat splat_of(const ProjectedSurfel<T>& p, int i, float opacity) {
  return {
      {lane(p.map.gx, i), lane(p.map.gy, i), lane(p.map.g0, i), lane(p.map.det, i)},
      lane(p.x_ref, i),
      lane(p.y_ref, i),
      lane(p.center_x, i),
      lane(p.center_y, i),
      opacity,
      lane(p.z_center, i),
      lane(p.normal, i)};
}

// First pixel whose centre is at or right of x, clamped to [0, size].
int first_pixel(float x, int size) {
  return static_cast<int>(std::clamp(std::ceil(x - 0.5f), 0.0f, static_cast<float>(size)));
}

// Comparisons are false for NaN, so surfels with broken parameters reach no tile.
template <class T>
PixelBox pixel_box_of(const ProjectedSurfel<T>& p, int i, const CameraOf<float>& camera) {
  const float x0 = lane(p.box_min_x, i), x1 = lane(p.box_max_x, i);
  const float y0 = lane(p.box_min_y, i), y1 = lane(p.box_max_y, i);
  if (!(x0 <= x1) || !(y0 <= y1)) return {};
  const int width = static_cast<int>(camera.width), height = static_cast<int>(camera.height);
  return {
      first_pixel(x0, width),
      first_pixel(x1, width),
      first_pixel(y0, height),
      first_pixel(y1, height)};
}

template <class T>
void project_lanes(
    const RasterInput& input, const CameraOf<float>& camera, std::size_t first, TileLists& lists
) {
  float max_rho[8];
  for (int i = 0; i < kLanesOf<T>; ++i) max_rho[i] = max_rho_of(input.opacities[first + i]);
  const ProjectedSurfel<T> p = project_surfel(
      load_geometry<T>(input, first), broadcast_camera<T>(camera), load_lanes<T>(max_rho)
  );
  for (int i = 0; i < kLanesOf<T>; ++i) {
    lists.splats[first + i] = splat_of(p, i, input.opacities[first + i]);
    lists.boxes[first + i] = pixel_box_of(p, i, camera);
  }
}

void project_all(
    const RasterInput& input, const CameraOf<float>& camera, bool scalar, TileLists& lists
) {
  lists.splats.resize(input.count);
  lists.boxes.resize(input.count);
  parallel_for_blocks(input.count, kGrain, [&](std::size_t begin, std::size_t end) {
    std::size_t i = begin;
    if (!scalar)
      for (; i + 8 <= end; i += 8) project_lanes<Float8>(input, camera, i, lists);
    for (; i < end; ++i) project_lanes<float>(input, camera, i, lists);
  });
}

void sort_by_depth(TileLists& lists) {
  lists.order.clear();
  lists.pair_begin.resize(lists.boxes.size() + 1);
  std::uint32_t pairs = 0;
  for (std::uint32_t i = 0; i < lists.boxes.size(); ++i) {
    lists.pair_begin[i] = pairs;
    if (lists.boxes[i].empty()) continue;
    pairs += static_cast<std::uint32_t>(lists.boxes[i].num_tiles());
    lists.order.push_back({sortable_bits(lists.splats[i].z_center), i});
  }
  lists.pair_begin.back() = pairs;
  radix_sort(lists.order, lists.scratch);
}

// Calls f(tile, surfel) for every pair whose tile row lies in [row_begin, row_end), front to back.
template <class F>
void for_each_pair(const TileLists& lists, int row_begin, int row_end, F&& f) {
  for (const KeyedIndex& item : lists.order) {
    const PixelBox& box = lists.boxes[item.index];
    const int y1 = std::min(row_end, box.tile_y_max()), x1 = box.tile_x_max();
    for (int y = std::max(row_begin, box.tile_y_min()); y < y1; ++y)
      for (int x = box.tile_x_min(); x < x1; ++x) f(y * lists.tiles_x + x, item.index);
  }
}

void list_tiles(TileLists& lists) {
  const auto for_bands = [&](auto&& body) {
    parallel_for(kBands, 1, [&](std::size_t band) {
      const int b = static_cast<int>(band);
      body(b * lists.tiles_y / kBands, (b + 1) * lists.tiles_y / kBands);
    });
  };
  lists.tile_begin.assign(lists.num_tiles() + 1, 0);
  for_bands([&](int begin, int end) {
    for_each_pair(lists, begin, end, [&](int tile, std::uint32_t) {
      ++lists.tile_begin[tile + 1];
    });
  });
  for (std::size_t i = 0; i < lists.num_tiles(); ++i)
    lists.tile_begin[i + 1] += lists.tile_begin[i];
  lists.surfel_ids.resize(lists.tile_begin.back());
  std::vector<std::uint32_t> next(lists.tile_begin.begin(), lists.tile_begin.end() - 1);
  for_bands([&](int begin, int end) {
    for_each_pair(lists, begin, end, [&](int tile, std::uint32_t surfel) {
      lists.surfel_ids[next[tile]++] = surfel;
    });
  });
}

}  // namespace

CameraOf<float> camera_of(const Camera& camera, float near_plane) {
  return {
      cast<float>(camera.rotation_cam_from_world),
      cast<float>(camera.translation_cam_from_world),
      static_cast<float>(camera.fx),
      static_cast<float>(camera.fy),
      static_cast<float>(camera.cx),
      static_cast<float>(camera.cy),
      static_cast<float>(camera.width),
      static_cast<float>(camera.height),
      near_plane};
}

template <class T>
SurfelGeometry<T> load_geometry(const RasterInput& input, std::size_t i) {
  const float *m = &input.means[3 * i], *s = &input.scales[2 * i], *q = &input.rotations[4 * i];
  return {
      {load_strided<T>(m, 3), load_strided<T>(m + 1, 3), load_strided<T>(m + 2, 3)},
      {load_strided<T>(s, 2), load_strided<T>(s + 1, 2)},
      {load_strided<T>(q, 4),
       load_strided<T>(q + 1, 4),
       load_strided<T>(q + 2, 4),
       load_strided<T>(q + 3, 4)}};
}
template SurfelGeometry<float> load_geometry(const RasterInput&, std::size_t);
template SurfelGeometry<Float8> load_geometry(const RasterInput&, std::size_t);

void build_tile_lists(
    const RasterInput& input, const Camera& camera, float near_plane, bool scalar, TileLists& lists
) {
  lists.tiles_x = (camera.width + kTileSize - 1) / kTileSize;
  lists.tiles_y = (camera.height + kTileSize - 1) / kTileSize;
  project_all(input, camera_of(camera, near_plane), scalar, lists);
  sort_by_depth(lists);
  list_tiles(lists);
}

}  // namespace glint
