// SPDX-License-Identifier: MIT
// Rasterizer and Tracer on an executor (raster_pipeline.h, trace_pipeline.h), and everything that
// makes an executor the GPU that ops run on.
#pragma once

#include "glint/cuda/kernels.h"
#include "glint/cuda/raster_pipeline.h"
#include "glint/cuda/trace_pipeline.h"
#include "glint/render/op_backends.h"
#include "glint/render/raster_tiles.h"

namespace glint::gpu {

// Gradients of outputs are only read; empty images are null.
inline float* pointer(const Image& image) {
  return image.empty() ? nullptr : const_cast<float*>(image.data());
}

inline DeviceSurfels device_surfels(const RasterInput& in) {
  return {
      .count = in.count,
      .channels = in.channels,
      .means = in.means.data(),
      .scales = in.scales.data(),
      .rotations = in.rotations.data(),
      .opacities = in.opacities.data(),
      .features = in.features.data()};
}
inline float* pointer(FloatArray& array) { return array.empty() ? nullptr : array.data(); }
inline DeviceMaps device_maps(const RasterMaps<ImageMap>& maps) {
  DeviceMaps result;
  for_each_map(
      {}, [](const char*, int, float*& to, const Image& map) { to = pointer(map); }, result, maps
  );
  return result;
}
inline DeviceGradients device_gradients(RasterGradient& g) {
  return {
      .means = g.means.data(),
      .scales = g.scales.data(),
      .rotations = g.rotations.data(),
      .opacities = g.opacities.data(),
      .features = g.features.data(),
      .screen = g.screen.data(),
      .screen_abs = pointer(g.screen_abs)};
}
inline DeviceRasterCall device_call(const RasterCall& call, RasterOutput& output) {
  return {
      .surfels = device_surfels(call.input),
      .camera = camera_of(call),
      .near_limit = call.input.near_limit.data,
      .has = call.maps(),
      .range = distortion_range(call.settings),
      .out = device_maps(output),
      .seen = {
          .visibility = output.visibility.data(),
          .in_view = output.in_view.data(),
          .owned_pixels = pointer(output.owned_pixels),
          .radii = pointer(output.radii)}};
}

template <class Exec>
class RasterizerOn final : public RasterBackend {
 public:
  void forward(const RasterCall& call, RasterOutput& output) override {
    pipeline_.forward(device_call(call, output));
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
      ImageView mask,
      const FirstSurfaceSettings& settings,
      Image& depth
  ) override {
    pipeline_.first_surface(mask.data, settings, depth.data());
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
      .means = in.means.data(),
      .scales = in.scales.data(),
      .rotations = in.rotations.data(),
      .opacities = in.opacities.data(),
      .sh_dc = in.sh_dc.data(),
      .sh_rest = in.sh_rest.data()};
}
template <class Maps>
DeviceTraceOutput device_output(const Maps& maps) {
  return {
      .color = pointer(maps.color),
      .alpha = pointer(maps.alpha),
      .depth_sum = pointer(maps.depth_sum),
      .normal = pointer(maps.normal)};
}
inline DeviceTraceGradients device_gradients(TraceGradient& g) {
  return {
      .means = g.means.data(),
      .scales = g.scales.data(),
      .rotations = g.rotations.data(),
      .opacities = g.opacities.data(),
      .sh_dc = g.sh_dc.data(),
      .sh_rest = g.sh_rest.data(),
      .visibility = g.visibility.data(),
      .half_depths = g.half_depths.data(),
      .origins = g.rays.origins.data(),
      .directions = g.rays.directions.data()};
}
inline TraceCutoffs cutoffs(const TraceSettings& s) {
  return {s.near, s.max_rho, s.min_alpha, s.min_transmittance, s.max_hits};
}
inline DeviceTraceCall device_call(const TraceCall& call, const TraceOutput& output) {
  return {
      .input = device_input(call.input),
      .rays = {call.rays.origins.data(), call.rays.directions.data()},
      .num_rays = call.rays.origins.num_pixels(),
      .cutoffs = cutoffs(call.settings),
      .out = device_output(output),
      .width = static_cast<std::size_t>(call.rays.origins.width())};
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
  use_gpu(backend);
}

}  // namespace glint::gpu
