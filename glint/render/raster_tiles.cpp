// SPDX-License-Identifier: MIT
#include "glint/render/raster_tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "glint/core/error.h"
#include "glint/core/parallel.h"
#include "glint/core/simd.h"

namespace glint {

static float lane_of(Float8 v, int i) { return v[i]; }  // for splat_of()

namespace {

constexpr std::size_t kGrain = 1024;  // surfels a block

template <class T>
PixelBox pixel_box_of(const ProjectedSurfel<T>& p, int i, const CameraOf<float>& camera) {
  return pixel_box(
      lane_of(p.box_min_x, i),
      lane_of(p.box_max_x, i),
      lane_of(p.box_min_y, i),
      lane_of(p.box_max_y, i),
      camera
  );
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
    lists.splats[first + i] = splat_of(p, input.opacities[first + i], i);
    lists.boxes[first + i] = pixel_box_of(p, i, camera);
  }
}

void project_all(
    const RasterInput& input, const CameraOf<float>& camera, bool with_lanes, TileLists& lists
) {
  lists.splats.resize(input.count);
  lists.boxes.resize(input.count);
  parallel_for_blocks(input.count, kGrain, [&](std::size_t begin, std::size_t end) {
    std::size_t i = begin;
    if (with_lanes)
      for (; i + 8 <= end; i += 8) project_lanes<Float8>(input, camera, i, lists);
    for (; i < end; ++i) project_lanes<float>(input, camera, i, lists);
  });
}

void sort_by_depth(TileLists& lists) {
  lists.order.clear();
  for (std::uint32_t i = 0; i < lists.boxes.size(); ++i)
    if (!lists.boxes[i].empty())
      lists.order.push_back({sortable_bits(lists.splats[i].z_center), i});
  radix_sort(lists.order, lists.scratch);
}

// Surfels per tile: every box adds its corners' signs, sums along rows and columns fill it in.
std::vector<std::uint32_t> count_tiles(const TileLists& lists) {
  const int stride = lists.tiles_x + 1;
  std::vector<std::uint32_t> corners(static_cast<std::size_t>(stride) * (lists.tiles_y + 1));
  for (const PixelBox& box : lists.boxes) {
    if (box.empty()) continue;
    const int x0 = box.tile_x_min(), x1 = box.tile_x_max();
    const int y0 = box.tile_y_min() * stride, y1 = box.tile_y_max() * stride;
    ++corners[y0 + x0];
    --corners[y0 + x1];
    --corners[y1 + x0];
    ++corners[y1 + x1];
  }
  std::vector<std::uint32_t> counts(lists.num_tiles()), column(lists.tiles_x);
  for (int y = 0; y < lists.tiles_y; ++y) {
    std::uint32_t row = 0;
    for (int x = 0; x < lists.tiles_x; ++x) {
      row += corners[y * stride + x];
      column[x] += row;
      counts[y * lists.tiles_x + x] = column[x];
    }
  }
  return counts;
}

void list_pair(TileLists& lists, std::uint32_t surfel, std::uint32_t pair, std::uint32_t place) {
  lists.entries[place] = surfel;
  lists.places[pair] = place;
}

// Lists the surfels of the tile rows [row_begin, row_end), front to back. next: where each tile's
// next entry goes.
void list_rows(TileLists& lists, int row_begin, int row_end, std::vector<std::uint32_t>& next) {
  for (const KeyedIndex& item : lists.order) {
    const PixelBox& box = lists.boxes[item.index];
    const int x0 = box.tile_x_min(), x1 = box.tile_x_max();
    const int y0 = std::max(row_begin, box.tile_y_min()), y1 = std::min(row_end, box.tile_y_max());
    std::uint32_t pair = lists.pair_begin[item.index] + (y0 - box.tile_y_min()) * (x1 - x0);
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x)
        list_pair(lists, item.index, pair++, next[y * lists.tiles_x + x]++);
  }
}

// Every band of tile rows walks all surfels: one band a thread. The lists do not depend on bands.
void list_tiles(TileLists& lists) {
  std::vector<std::uint32_t> next = count_tiles(lists);
  lists.tile_begin.assign(1, 0);
  for (std::uint32_t& n : next) {
    lists.tile_begin.push_back(lists.tile_begin.back() + n);
    n = lists.tile_begin.end()[-2];
  }
  lists.entries.resize(lists.tile_begin.back());
  lists.places.resize(lists.tile_begin.back());
  const int bands = num_threads();
  parallel_for(static_cast<std::size_t>(bands), 1, [&](std::size_t band) {
    const int b = static_cast<int>(band);
    list_rows(lists, b * lists.tiles_y / bands, (b + 1) * lists.tiles_y / bands, next);
  });
}

}  // namespace

CameraOf<float> camera_of(const RasterCall& call) {
  const Camera& camera = call.camera;
  return {
      cast<float>(camera.rotation_cam_from_world),
      cast<float>(camera.translation_cam_from_world),
      static_cast<float>(camera.fx),
      static_cast<float>(camera.fy),
      static_cast<float>(camera.cx),
      static_cast<float>(camera.cy),
      static_cast<float>(camera.width),
      static_cast<float>(camera.height),
      call.settings.near_plane};
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

void check_num_pairs(bool countable, std::size_t most, std::size_t surfels, ImageSize size) {
  GLINT_CHECK(
      countable,
      kUsage,
      "{} surfels reach more tiles of an image of {}x{} pixels than can be listed (most pairs of "
      "surfel and tile: {}): use fewer surfels (max_surfels), smaller ones, or smaller images",
      surfels,
      size.width,
      size.height,
      most
  );
}

void number_pairs(
    const std::vector<PixelBox>& boxes, ImageSize size, std::vector<std::uint32_t>& pair_begin
) {
  constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
  pair_begin.resize(boxes.size() + 1);
  std::uint64_t pairs = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    pair_begin[i] = static_cast<std::uint32_t>(pairs);
    pairs += static_cast<std::uint64_t>(boxes[i].num_tiles());
  }
  check_num_pairs(pairs <= kMost, kMost, boxes.size(), size);
  pair_begin.back() = static_cast<std::uint32_t>(pairs);
}

void build_tile_lists(const RasterCall& call, TileLists& lists) {
  lists.tiles_x = (call.camera.width + kTileSize - 1) / kTileSize;
  lists.tiles_y = (call.camera.height + kTileSize - 1) / kTileSize;
  project_all(call.input, camera_of(call), call.settings.lanes > 1, lists);
  number_pairs(lists.boxes, call.camera.size(), lists.pair_begin);
  sort_by_depth(lists);
  list_tiles(lists);
}

}  // namespace glint
