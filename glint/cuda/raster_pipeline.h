// SPDX-License-Identifier: MIT
// The order of kernels that makes a rasterisation, forward and backward, for an executor: the GPU's
// (device_exec.cuh) or the tests' on the host. An executor offers Buffer<T>, for_each, launch,
// exclusive_sum, sort_pairs and fill_zero.
#pragma once

#include <vector>

#include "glint/cuda/raster_bodies.h"

namespace glint::gpu {

// A rasterisation in device memory; shapes of RasterCall and RasterOutput.
struct DeviceRasterCall {
  DeviceSurfels surfels;
  CameraOf<float> camera;
  const float* near_limit;  // null: none
  MapChannels has;
  DistortionRange range;
  DeviceMaps out;
  DeviceSeen seen;
};

template <class Exec>
class RasterPipeline {
 public:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;
  template <int>
  using BufferMap = Buffer<float>;

  explicit RasterPipeline(Exec& exec) : exec_(exec) {}

  void forward(const DeviceRasterCall& call) {
    call_ = call;
    list_tiles(call.surfels, call.camera);
    exec_.for_each(call.surfels.count, ResetSeen{num_tiles_.data(), call.seen});
    if (call.has.statistics)
      exec_.for_each(
          call.surfels.count,
          ScreenRadii{call.surfels, call.camera, num_tiles_.data(), call.seen.radii}
      );
    fit_kept();
    pass_.splats = splats_.data();
    pass_.features = call.surfels.features;
    pass_.pairs = pair_surfels_.data();
    pass_.ranges = ranges_.data();
    pass_.near_limit = call.near_limit;
    pass_.near_plane = call.camera.near_plane;
    pass_.has = call.has;
    pass_.range = call.range;
    with_pass_code(pass_.has, [&]<class Code>() {
      exec_.launch(
          ranges_.size(),
          ForwardTile<Code>{pass_, call.out, kept_, call.seen.visibility, call.seen.owned_pixels}
      );
    });
  }

  // Of the last forward call.
  void backward(const DeviceMaps& dL_dout, const DeviceGradients& gradients) {
    with_pass_code(pass_.has, [&]<class Code>() {
      using Tile = BackwardTile<Code>;
      gradient_sums_.resize(call_.surfels.count * Tile::kSums);
      exec_.fill_zero(gradient_sums_);
      exec_.launch(ranges_.size(), Tile{pass_, call_.out, dL_dout, kept_, gradient_sums_.data()});
      vjp_of_surfels(Tile::kSums, gradients);
    });
  }

  // Of the last forward call. mask, depth: [H][W].
  void first_surface(const float* mask, const FirstSurfaceSettings& settings, float* depth) {
    exec_.for_each(
        static_cast<std::size_t>(pass_.width) * static_cast<std::size_t>(pass_.height),
        FirstSurface{pass_, call_.out, mask, settings, depth}
    );
  }

  std::size_t num_pairs() const { return num_pairs_; }
  // Pixels inside the surfels' screen boxes. Waits for the device.
  std::size_t num_pixel_pairs() {
    std::vector<PixelBox> boxes(boxes_.size());
    exec_.download(boxes_, boxes.size(), boxes.data());
    std::size_t sum = 0;
    for (const PixelBox& box : boxes) sum += box.num_pixels();
    return sum;
  }

 private:
  void list_tiles(const DeviceSurfels& surfels, const CameraOf<float>& camera) {
    const std::size_t n = surfels.count;
    pass_.width = static_cast<int>(camera.width);
    pass_.height = static_cast<int>(camera.height);
    const TileGrid grid = tile_grid(pass_.width, pass_.height);
    splats_.resize(n);
    boxes_.resize(n);
    num_tiles_.resize(n);
    exec_.for_each(
        n, ProjectSurfels{surfels, camera, splats_.data(), boxes_.data(), num_tiles_.data()}
    );
    num_pairs_ = exec_.exclusive_sum(num_tiles_, n, first_pair_);
    keys_.resize(num_pairs_);
    pair_surfels_.resize(num_pairs_);
    exec_.for_each(
        n,
        WritePairs{
            splats_.data(),
            boxes_.data(),
            first_pair_.data(),
            grid,
            keys_.data(),
            pair_surfels_.data()}
    );
    int bits = 32;
    while (grid.count() >> (bits - 32) > 0) ++bits;
    exec_.sort_pairs(num_pairs_, bits, keys_, pair_surfels_);
    ranges_.resize(static_cast<std::size_t>(grid.count()));
    exec_.fill_zero(ranges_);
    exec_.for_each(num_pairs_, FindTileRanges{keys_.data(), num_pairs_, ranges_.data()});
  }
  void vjp_of_surfels(int stride, const DeviceGradients& gradients) {
    exec_.for_each(
        call_.surfels.count,
        SurfelVjp{
            call_.surfels,
            call_.camera,
            splats_.data(),
            num_tiles_.data(),
            gradient_sums_.data(),
            stride,
            call_.has,
            gradients}
    );
  }
  void fit_kept() {
    const auto pixels = static_cast<std::size_t>(pass_.width * pass_.height);
    for_each_kept_map(
        call_.has,
        [&](int width, float, float*& map, Buffer<float>& memory) {
          memory.resize(static_cast<std::size_t>(width) * pixels);
          map = memory.data();
        },
        kept_,
        kept_memory_
    );
  }

  Exec& exec_;
  DeviceRasterCall call_{};
  TilePass pass_{};
  std::size_t num_pairs_ = 0;
  Buffer<Splat> splats_;
  Buffer<PixelBox> boxes_;
  Buffer<std::uint32_t> num_tiles_, first_pair_, pair_surfels_;
  Buffer<std::uint64_t> keys_;
  Buffer<PairRange> ranges_;
  KeptMaps<BufferMap> kept_memory_;
  DeviceKept kept_;
  Buffer<float> gradient_sums_;
};

}  // namespace glint::gpu
