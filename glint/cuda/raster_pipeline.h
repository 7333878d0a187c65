// SPDX-License-Identifier: MIT
// The order of kernels that makes a rasterisation, forward and backward, for an executor: the GPU's
// (device_exec.cuh) or the tests' on the host. An executor offers Buffer<T>, for_each, launch,
// exclusive_sum_on_device, sort_pairs, download and fill_zero. docs/design/gpu.md: what it costs.
#pragma once

#include <cstring>
#include <memory>

#include "glint/cuda/raster_sums.h"
#include "glint/cuda/splat_lists.h"

namespace glint::gpu {

// A rasterisation in device memory; shapes of RasterCall and RasterOutput.
struct DeviceRasterCall {
  DeviceSurfels surfels;
  CameraOf<float> camera;
  const float* near_limit;  // null: none
  MapChannels has;
  bool screen_with_low_pass;
  DistortionRange range;
  DeviceMaps out;
  DeviceSeen seen;
  GeometryRevision revision = {};
  // A word on the device that becomes 1 where a silent step (glint/core/device.h) had too little
  // room: then nothing was listed, and maps or gradients are those of no surfels. May be null.
  std::uint32_t* overflow = nullptr;
};

template <class Exec>
class RasterPipeline {
 public:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;
  template <int>
  using BufferMap = Buffer<float>;

  explicit RasterPipeline(Exec& exec) : exec_(exec) {}
  RasterPipeline(const RasterPipeline&) = delete;
  RasterPipeline& operator=(const RasterPipeline&) = delete;

  // `other`: one that has just rasterised the same surfels with the same camera, if there is such a
  // one, to use its splats and lists: surfels on their own, say, behind those behind an interface.
  // Features, near limit and maps may differ. It must rasterise nothing else before backward().
  // Where its arrays, their revision or its camera are others, it is not used. Where its lists had
  // no room in a silent step, neither has this pass, and the step is void already.
  void forward(const DeviceRasterCall& call, RasterPipeline* other = nullptr) {
    const bool share = other != nullptr && other != this && other->has_lists_of(call);
    lists_ = share ? other->lists_ : own_lists_;
    call_ = call;
    if (!share) own_lists_->make(exec_, call.surfels, call.camera, call.overflow);
    begin_pass();
    with_pass_code(pass_.has, [&]<class Code>() {
      exec_.launch(
          lists_->num_tiles(), ForwardTile<Code>{pass_, call.out, kept_, slots(), ends_.data()}
      );
    });
    end_pass();
  }

  // Of the last forward call.
  void backward(const DeviceMaps& dL_dout, const DeviceGradients& gradients) {
    const std::size_t n = call_.surfels.count;
    const ImageSize size{pass_.lists.width, pass_.lists.height};
    const PairRoom room = counted_rows_.count(exec_, num_rows_, n, size, call_.overflow);
    with_pass_code(pass_.has, [&]<class Code>() {
      using Tile = BackwardTile<Code>;
      const PairCounts* first = counted_rows_.first();
      const PairTotals* totals = counted_rows_.totals();
      rows_.resize(std::size_t{room.pairs} * Tile::kSums);
      sums_.resize(n * Tile::kSums);
      exec_.launch(
          lists_->num_tiles(),
          Tile{
              pass_,
              call_.out,
              dL_dout,
              kept_,
              ends_.data(),
              ranks_.data(),
              first,
              totals,
              rows_.data()}
      );
      exec_.launch(
          blocks_of_sums(), SumRows<Tile::kSums>{n, first, totals, rows_.data(), sums_.data()}
      );
      vjp_of_surfels(Tile::kSums, gradients);
    });
  }

  // Of the last forward call. mask, depth: [H][W].
  void first_surface(const float* mask, const FirstSurfaceSettings& settings, float* depth) {
    exec_.for_each(num_pixels(), FirstSurface{pass_, call_.out, mask, settings, depth});
  }
  // The same; first, last: [H][W].
  void depth_modes(const DepthModeSettings& settings, float* first, float* last) {
    exec_.for_each(num_pixels(), DepthModesOfPixel{pass_, settings, first, last});
  }

  // Of the last forward call. They wait for the device.
  std::size_t num_pairs() { return lists_->num_pairs(exec_); }
  std::size_t num_pixel_pairs() { return lists_->num_pixel_pairs(exec_); }
  std::size_t num_rows() { return counted_rows_.read(exec_).pairs; }  // of the last backward call
  bool has_own_lists() const { return lists_ == own_lists_; }
  std::size_t num_slots() const { return lists_->num_slots(); }

 private:
  bool has_lists_of(const DeviceRasterCall& call) const {
    const DeviceSurfels &a = call_.surfels, &b = call.surfels;
    return lists_->num_tiles() > 0 && a.count == b.count && a.means == b.means &&
           a.scales == b.scales && a.rotations == b.rotations && a.opacities == b.opacities &&
           call_.revision == call.revision &&
           std::memcmp(&call_.camera, &call.camera, sizeof call.camera) == 0;
  }
  std::size_t num_pixels() const {
    return static_cast<std::size_t>(pass_.lists.width) *
           static_cast<std::size_t>(pass_.lists.height);
  }
  std::size_t blocks_of_sums() const {
    return (call_.surfels.count + kSumSurfels - 1) / kSumSurfels;
  }
  DeviceSlots slots() {
    return {visibility_.data(), call_.has.statistics ? owned_.data() : nullptr, ranks_.data()};
  }
  void begin_pass() {
    pass_ = {
        .lists = lists_->lists(),
        .features = call_.surfels.features,
        .near_limit = call_.near_limit,
        .near_plane = call_.camera.near_plane,
        .has = call_.has,
        .range = call_.range};
    visibility_.resize(lists_->num_slots());
    ranks_.resize(lists_->num_slots());
    if (call_.has.statistics) owned_.resize(lists_->num_slots());
    exec_.fill_zero(visibility_);
    ends_.resize(lists_->num_tiles());
    fit_kept();
  }
  void end_pass() {
    num_rows_.resize(call_.surfels.count);
    exec_.launch(blocks_of_sums(), SumSlots{pass_.lists, slots(), call_.seen, num_rows_.data()});
    if (call_.has.statistics)
      exec_.for_each(
          call_.surfels.count,
          ScreenRadii{call_.surfels, call_.camera, pass_.lists, call_.seen.radii}
      );
  }
  void vjp_of_surfels(int stride, const DeviceGradients& gradients) {
    exec_.for_each(
        call_.surfels.count,
        SurfelVjp{
            call_.surfels,
            call_.camera,
            pass_.lists,
            sums_.data(),
            stride,
            call_.has,
            call_.screen_with_low_pass,
            gradients}
    );
  }
  void fit_kept() {
    for_each_kept_map(
        call_.has,
        [&](int width, float, float*& map, Buffer<float>& memory) {
          memory.resize(static_cast<std::size_t>(width) * num_pixels());
          map = memory.data();
        },
        kept_,
        kept_memory_
    );
  }

  Exec& exec_;
  DeviceRasterCall call_{};
  TilePass pass_{};
  std::shared_ptr<SplatLists<Exec>> own_lists_ = std::make_shared<SplatLists<Exec>>();
  std::shared_ptr<SplatLists<Exec>> lists_ = own_lists_;  // of the last forward call
  KeptMaps<BufferMap> kept_memory_;
  DeviceKept kept_;
  Buffer<float> visibility_;  // of slots
  Buffer<std::uint8_t> owned_;
  Buffer<std::uint32_t> ranks_;
  Buffer<std::uint32_t> ends_;  // of tiles
  Buffer<PairCounts> num_rows_;
  CountedRoom<Exec> counted_rows_;
  Buffer<float> rows_, sums_;
};

}  // namespace glint::gpu
