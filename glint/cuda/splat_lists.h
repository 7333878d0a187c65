// SPDX-License-Identifier: MIT
// The order of kernels that projects surfels and lists them per tile, for an executor
// (raster_pipeline.h).
#pragma once

#include <algorithm>
#include <vector>

#include "glint/core/device.h"
#include "glint/cuda/raster_lists.h"
#include "glint/render/raster_tiles.h"

namespace glint::gpu {

inline PairRoom with_margin(const PairTotals& totals) {
  const auto more = [](std::uint32_t n, std::uint32_t most) {
    const std::uint64_t room = std::max<std::uint64_t>(std::uint64_t{n} + n / 2, 1);
    return static_cast<std::uint32_t>(std::min(room, std::uint64_t{most}));
  };
  return {more(totals.pairs, kMostPairs.pairs), more(totals.slots, kMostPairs.slots)};
}

// Sums of counts on the device, and room for what they count. Outside of silent steps
// (glint/core/device.h) the host waits for them and the room is exact. In one it is what the calls
// before needed, and half as much again; where that is too little, `totals` says so.
template <class Exec>
class CountedRoom {
 public:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  // Of counts[0, n), of n surfels in an image of `size`. overflow: see TakeTotals. Errors (kUsage),
  // where the host waits: there are more than kMostPairs.
  PairRoom count(
      Exec& exec,
      const Buffer<PairCounts>& counts,
      std::size_t n,
      ImageSize size,
      std::uint32_t* overflow
  ) {
    const bool silent = SilentStep::now() && learned_.pairs > 0;
    exec.exclusive_sum_on_device(counts, n, first_, AddPairCounts{});
    totals_.resize(1);
    const PairRoom room = silent ? learned_ : kMostPairs;
    exec.for_each(1, TakeTotals{first_.data() + n, room, totals_.data(), overflow});
    if (silent) return room;
    const PairTotals totals = read(exec);
    check_num_pairs(totals.fit != 0, kMostPairs.pairs, n, size);
    const PairRoom more = with_margin(totals);
    learned_ = {std::max(learned_.pairs, more.pairs), std::max(learned_.slots, more.slots)};
    return {totals.pairs, totals.slots};
  }
  // Waits for the device.
  PairTotals read(Exec& exec) {
    PairTotals totals{};
    if (totals_.size() > 0) exec.download(totals_, 1, &totals);
    return totals;
  }
  const PairCounts* first() const { return first_.data(); }
  const PairTotals* totals() const { return totals_.data(); }

 private:
  Buffer<PairCounts> first_;
  Buffer<PairTotals> totals_;
  PairRoom learned_;
};

template <class Exec>
class SplatLists {
 public:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  // overflow: see TakeTotals.
  void make(
      Exec& exec,
      const DeviceSurfels& surfels,
      const CameraOf<float>& camera,
      std::uint32_t* overflow
  ) {
    lists_.count = surfels.count;
    lists_.width = static_cast<int>(camera.width);
    lists_.height = static_cast<int>(camera.height);
    project(exec, surfels, camera);
    room_ = counted_.count(exec, counts_, surfels.count, {lists_.width, lists_.height}, overflow);
    write_pairs(exec);
    point();
  }
  const DeviceLists& lists() const { return lists_; }
  std::size_t num_slots() const { return room_.slots; }  // that there is room for
  std::size_t num_tiles() const { return ranges_.size(); }

  // Both wait for the device.
  std::size_t num_pairs(Exec& exec) { return counted_.read(exec).pairs; }
  std::size_t num_pixel_pairs(Exec& exec) {
    std::vector<PixelBox> boxes(boxes_.size());
    exec.download(boxes_, boxes.size(), boxes.data());
    std::size_t sum = 0;
    for (const PixelBox& box : boxes) sum += box.num_pixels();
    return sum;
  }

 private:
  void project(Exec& exec, const DeviceSurfels& surfels, const CameraOf<float>& camera) {
    splats_.resize(surfels.count);
    boxes_.resize(surfels.count);
    counts_.resize(surfels.count);
    exec.for_each(
        surfels.count,
        ProjectSurfels{surfels, camera, splats_.data(), boxes_.data(), counts_.data()}
    );
  }
  void write_pairs(Exec& exec) {
    const TileGrid grid = tile_grid(lists_.width, lists_.height);
    const std::size_t room = room_.pairs;
    keys_.resize(room);
    surfels_.resize(room);
    exec.for_each(
        lists_.count,
        WritePairs{
            splats_.data(),
            boxes_.data(),
            counted_.first(),
            counted_.totals(),
            grid,
            keys_.data(),
            surfels_.data()}
    );
    if (SilentStep::now())
      exec.for_each(room, ClearTail{counted_.totals(), keys_.data(), surfels_.data()});
    int bits = 32;
    while (grid.count() >> (bits - 32) > 0) ++bits;
    exec.sort_pairs(room, bits, keys_, surfels_);
    ranges_.resize(static_cast<std::size_t>(grid.count()));
    exec.fill_zero(ranges_);
    exec.for_each(room, FindTileRanges{keys_.data(), counted_.totals(), ranges_.data()});
  }
  void point() {
    lists_.splats = splats_.data();
    lists_.boxes = boxes_.data();
    lists_.first = counted_.first();
    lists_.totals = counted_.totals();
    lists_.pairs = surfels_.data();
    lists_.ranges = ranges_.data();
  }

  DeviceLists lists_{};
  PairRoom room_;
  CountedRoom<Exec> counted_;
  Buffer<Splat> splats_;
  Buffer<PixelBox> boxes_;
  Buffer<PairCounts> counts_;
  Buffer<std::uint64_t> keys_;
  Buffer<std::uint32_t> surfels_;
  Buffer<PairRange> ranges_;
};

}  // namespace glint::gpu
