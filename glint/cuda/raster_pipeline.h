// SPDX-License-Identifier: MIT
// The order of kernels that makes a rasterisation, forward and backward, for an executor: the GPU's
// (device_exec.cuh) or the tests' on the host. An executor offers Buffer<T>, for_each, launch,
// exclusive_sum, sort_pairs and fill_zero.
#pragma once

#include <vector>

#include "glint/cuda/raster_bodies.h"

namespace glint::gpu {

template <class Exec>
class RasterPipeline {
 public:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  explicit RasterPipeline(Exec& exec) : exec_(exec) {}

  void forward(
      const DeviceSurfels& surfels,
      const CameraOf<float>& camera,
      const float* near_limit,
      const DistortionRange& range,
      const DeviceImages& out,
      float* visibility,
      std::uint8_t* in_view
  ) {
    list_tiles(surfels, camera);
    exec_.for_each(surfels.count, ResetVisibility{num_tiles_.data(), visibility, in_view});
    const auto pixels = static_cast<std::size_t>(pass_.width * pass_.height);
    final_transmittance_.resize(pixels);
    for (auto* image : {&first_depth_, &moment1_, &moment2_}) image->resize(range.on ? pixels : 0);
    pass_.splats = splats_.data();
    pass_.features = surfels.features;
    pass_.pairs = pair_surfels_.data();
    pass_.ranges = ranges_.data();
    pass_.near_limit = near_limit;
    pass_.near_plane = camera.near_plane;
    pass_.channels = surfels.channels;
    pass_.range = range;
    with_channels([&]<int kChannels>() {
      exec_.launch(ranges_.size(), ForwardTile<kChannels>{pass_, out, sums(), visibility});
    });
  }

  // Of the last forward call.
  void backward(
      const DeviceSurfels& surfels,
      const CameraOf<float>& camera,
      const DeviceImages& out,
      const DeviceImages& dL_dout,
      const DeviceGradients& gradients
  ) {
    with_channels([&]<int kChannels>() {
      constexpr int kSums = BackwardTile<kChannels>::kSums;
      gradient_sums_.resize(surfels.count * kSums);
      exec_.fill_zero(gradient_sums_);
      exec_.launch(
          ranges_.size(),
          BackwardTile<kChannels>{pass_, out, dL_dout, sums(), gradient_sums_.data()}
      );
      exec_.for_each(
          surfels.count,
          SurfelVjp{
              surfels,
              camera,
              splats_.data(),
              num_tiles_.data(),
              gradient_sums_.data(),
              kSums,
              gradients}
      );
    });
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
  DeviceSums sums() {
    return {final_transmittance_.data(), first_depth_.data(), moment1_.data(), moment2_.data()};
  }
  template <class F>
  void with_channels(F&& body) {
    if (pass_.channels == 3) return body.template operator()<3>();
    if (pass_.channels == 5) return body.template operator()<5>();
    body.template operator()<0>();
  }

  Exec& exec_;
  TilePass pass_{};
  std::size_t num_pairs_ = 0;
  Buffer<Splat> splats_;
  Buffer<PixelBox> boxes_;
  Buffer<std::uint32_t> num_tiles_, first_pair_, pair_surfels_;
  Buffer<std::uint64_t> keys_;
  Buffer<PairRange> ranges_;
  Buffer<float> final_transmittance_, first_depth_, moment1_, moment2_;
  Buffer<float> gradient_sums_;
};

}  // namespace glint::gpu
