// SPDX-License-Identifier: MIT
// Rasterizer and Tracer on an executor (raster_pipeline.h, trace_pipeline.h), and everything that
// makes an executor the GPU that ops run on.
#pragma once

#include "glint/cuda/kernels.h"
#include "glint/cuda/raster_pipeline.h"
#include "glint/cuda/trace_pipeline.h"
#include "glint/render/op_backends.h"
#include "glint/render/raster_tiles.h"
#include "glint/render/void_steps.h"

namespace glint::gpu {

// What a call writes; gradients of outputs are only read, through the same type. Empty ones are
// null.
inline float* pointer(Image& image) { return image.on_device(); }
inline float* pointer(const Image& image) {
  return const_cast<float*>(image.array().device_for_reading());
}

inline DeviceSurfels device_surfels(const RasterInput& in) {
  return {
      .count = in.count,
      .channels = in.channels,
      .means = in.means.on_device(),
      .scales = in.scales.on_device(),
      .rotations = in.rotations.on_device(),
      .opacities = in.opacities.on_device(),
      .features = in.features.on_device()};
}
template <class Maps>
DeviceMaps device_maps(Maps& maps) {
  DeviceMaps result;
  for_each_map(
      {}, [](const char*, int, float*& to, auto& map) { to = pointer(map); }, result, maps
  );
  return result;
}
inline DeviceGradients device_gradients(RasterGradient& g) {
  return {
      .means = g.means.on_device(),
      .scales = g.scales.on_device(),
      .rotations = g.rotations.on_device(),
      .opacities = g.opacities.on_device(),
      .features = g.features.on_device(),
      .screen = g.screen.on_device(),
      .screen_abs = g.screen_abs.on_device()};
}
// Of a RasterInput or a TraceInput.
inline GeometryRevision revision_of(const auto& in) {
  return {
      in.means.device_revision(),
      in.scales.device_revision(),
      in.rotations.device_revision(),
      in.opacities.device_revision()};
}
inline DeviceRasterCall device_call(const RasterCall& call, RasterOutput& output) {
  return {
      .surfels = device_surfels(call.input),
      .camera = camera_of(call),
      .near_limit = call.input.near_limit.get().array().device_for_reading(),
      .has = call.maps(),
      .screen_with_low_pass = call.settings.screen_with_low_pass,
      .range = distortion_range(call.settings),
      .out = device_maps(output),
      .seen =
          {.visibility = output.visibility.on_device(),
           .in_view = output.in_view.on_device(),
           .owned_pixels = output.owned_pixels.on_device(),
           .radii = output.radii.on_device()},
      .revision = revision_of(call.input),
      .overflow = void_word()};
}

template <class Exec>
class RasterizerOn final : public RasterBackend {
 public:
  void forward(const RasterCall& call, RasterOutput& output, RasterBackend* first) override {
    pipeline_.forward(
        device_call(call, output),
        first != nullptr ? &static_cast<RasterizerOn*>(first)->pipeline_ : nullptr
    );
  }
  void backward(
      const RasterCall&,
      const RasterOutput&,
      const RasterOutputGradient& dL_doutput,
      RasterGradient& gradient
  ) override {
    pipeline_.backward(device_maps(dL_doutput), device_gradients(gradient));
  }
  void first_surface(
      const RasterCall&,
      const RasterOutput&,
      const Image& mask,
      const FirstSurfaceSettings& settings,
      Image& depth
  ) override {
    pipeline_.first_surface(mask.on_device(), settings, depth.on_device());
  }
  void depth_modes(const RasterCall&, const DepthModeSettings& settings, Image& first, Image& last)
      override {
    pipeline_.depth_modes(settings, first.on_device(), last.on_device());
  }
  std::size_t num_pairs() override { return pipeline_.num_pairs(); }
  std::size_t num_pixel_pairs() override { return pipeline_.num_pixel_pairs(); }

 private:
  RasterPipeline<Exec> pipeline_{executor<Exec>()};
};

inline DeviceTraceInput device_input(const TraceInput& in) {
  return {
      .count = in.count,
      .sh_degree = in.sh_degree,
      .means = in.means.on_device(),
      .scales = in.scales.on_device(),
      .rotations = in.rotations.on_device(),
      .opacities = in.opacities.on_device(),
      .sh_dc = in.sh_dc.on_device(),
      .sh_rest = in.sh_rest.on_device()};
}
template <class Maps>
DeviceTraceOutput device_output(Maps& maps) {
  return {
      .color = pointer(maps.color),
      .alpha = pointer(maps.alpha),
      .depth_sum = pointer(maps.depth_sum),
      .normal = pointer(maps.normal)};
}
inline DeviceTraceGradients device_gradients(TraceGradient& g) {
  return {
      .means = g.means.on_device(),
      .scales = g.scales.on_device(),
      .rotations = g.rotations.on_device(),
      .opacities = g.opacities.on_device(),
      .sh_dc = g.sh_dc.on_device(),
      .sh_rest = g.sh_rest.on_device(),
      .visibility = g.visibility.on_device(),
      .half_depths = g.half_depths.on_device(),
      .origins = g.rays.origins.on_device(),
      .directions = g.rays.directions.on_device()};
}
inline TraceCutoffs cutoffs(const TraceSettings& s) {
  return {s.near, s.max_rho, s.min_alpha, s.min_transmittance, s.max_hits};
}
inline DeviceTraceCall device_call(const TraceCall& call, TraceOutput& output) {
  return {
      .input = device_input(call.input),
      .rays =
          {.origins = call.rays.origins.on_device(),
           .directions = call.rays.directions.on_device(),
           .count = call.rays.origins.num_pixels()},
      .num_rays = call.rays.origins.num_pixels(),
      .cutoffs = cutoffs(call.settings),
      .out = device_output(output),
      .width = static_cast<std::size_t>(call.rays.origins.width()),
      .revision = revision_of(call.input),
      .overflow = void_word()};
}

template <class Exec>
class TracerOn final : public TraceBackend {
 public:
  void forward(const TraceCall& call, TraceOutput& output) override {
    pipeline_.forward(device_call(call, output));
  }
  void backward(
      const TraceCall&,
      const TraceOutput&,
      const TraceOutputGradient& dL_doutput,
      TraceGradient& gradient
  ) override {
    pipeline_.backward(device_output(dL_doutput), device_gradients(gradient));
  }
  std::size_t num_hits() override { return pipeline_.num_hits(); }

 private:
  TracePipeline<Exec> pipeline_{executor<Exec>()};
};

// From arrays to an executor's memory, and back.
struct NumberKeys {
  const std::uint32_t* keys;
  std::uint32_t *copy, *order;
  GLINT_HD void operator()(std::size_t i) const {
    copy[i] = keys[i];
    order[i] = static_cast<std::uint32_t>(i);
  }
};
struct TakeSorted {
  const std::uint32_t *sorted_keys, *sorted_order;
  std::uint32_t *keys, *order;
  GLINT_HD void operator()(std::size_t i) const {
    keys[i] = sorted_keys[i];
    order[i] = sorted_order[i];
  }
};
template <class Exec>
void sort_on(Array<std::uint32_t>& keys, Array<std::uint32_t>& order) {
  static typename Exec::template Buffer<std::uint32_t> sorted_keys, sorted_order;
  Exec& exec = executor<Exec>();
  const std::size_t count = keys.size();
  order.resize(count);
  sorted_keys.resize(count);
  sorted_order.resize(count);
  exec.for_each(count, NumberKeys{keys.on_device(), sorted_keys.data(), sorted_order.data()});
  exec.sort_pairs(count, 32, sorted_keys, sorted_order);
  exec.for_each(
      count,
      TakeSorted{sorted_keys.data(), sorted_order.data(), keys.on_device(), order.on_device()}
  );
}

// Ops run on Exec from now on; `backend` offers its memory.
template <class Exec>
void use_executor(const DeviceBackend& backend) {
  offer_lists<Exec>(KernelLists{});
  gpu_ops.rasterizer = []() -> std::unique_ptr<RasterBackend> {
    return std::make_unique<RasterizerOn<Exec>>();
  };
  gpu_ops.tracer = []() -> std::unique_ptr<TraceBackend> {
    return std::make_unique<TracerOn<Exec>>();
  };
  gpu_ops.sort = sort_on<Exec>;
  use_gpu(backend);
}

}  // namespace glint::gpu
