// SPDX-License-Identifier: MIT
// Rasterizer and Tracer on an executor (raster_pipeline.h, trace_pipeline.h), and everything that
// makes an executor the GPU that ops run on.
#pragma once

#include "glint/cuda/kernels.h"
#include "glint/cuda/raster_pipeline.h"
#include "glint/cuda/trace_pipeline.h"
#include "glint/render/gpu_ops.h"
#include "glint/render/raster_saved.h"

namespace glint::gpu {

// Gradients of outputs are only read; empty images are null.
inline float* pointer(const Image& image) {
  return image.empty() ? nullptr : const_cast<float*>(image.data());
}

inline DeviceSurfels device_surfels(const RasterInput& in) {
  return {
      in.count,
      in.channels,
      in.means.data(),
      in.scales.data(),
      in.rotations.data(),
      in.opacities.data(),
      in.features.data()};
}
template <class Maps>
DeviceImages device_images(const Maps& maps) {
  return {
      pointer(maps.features),
      pointer(maps.alpha),
      pointer(maps.depth_sum),
      pointer(maps.depth_median),
      pointer(maps.normal),
      pointer(maps.distortion)};
}

template <class Exec>
class RasterizerOn final : public GpuRasterizer {
 public:
  void forward(
      const RasterInput& input,
      const Camera& camera,
      const RasterSettings& settings,
      RasterOutput& output
  ) override {
    pipeline_.forward(
        device_surfels(input),
        camera_of(camera, settings.near_plane),
        input.near_limit.data,
        distortion_range(settings),
        device_images(output),
        output.visibility.data(),
        output.in_view.data()
    );
  }
  void backward(
      const RasterInput& input,
      const Camera& camera,
      const RasterSettings& settings,
      const RasterOutput& output,
      const RasterOutputGradient& dL_doutput,
      RasterGradient& g
  ) override {
    pipeline_.backward(
        device_surfels(input),
        camera_of(camera, settings.near_plane),
        device_images(output),
        device_images(dL_doutput),
        {g.means.data(),
         g.scales.data(),
         g.rotations.data(),
         g.opacities.data(),
         g.features.data(),
         g.screen.data()}
    );
  }
  std::size_t num_pairs() const override { return pipeline_.num_pairs(); }
  std::size_t num_pixel_pairs() const override { return pipeline_.num_pixel_pairs(); }

 private:
  mutable RasterPipeline<Exec> pipeline_{executor<Exec>()};
};

inline DeviceTraceInput device_input(const TraceInput& in) {
  return {
      in.count,
      in.sh_degree,
      in.means.data(),
      in.scales.data(),
      in.rotations.data(),
      in.opacities.data(),
      in.sh_dc.data(),
      in.sh_rest.data()};
}
template <class Maps>
DeviceTraceOutput device_output(const Maps& maps) {
  return {pointer(maps.color), pointer(maps.alpha), pointer(maps.depth_sum), pointer(maps.normal)};
}
inline TraceCutoffs cutoffs(const TraceSettings& s) {
  return {s.near, s.max_rho, s.min_alpha, s.min_transmittance, s.max_hits};
}

template <class Exec>
class TracerOn final : public GpuTracer {
 public:
  void forward(
      const TraceInput& input, const Rays& rays, const TraceSettings& settings, TraceOutput& output
  ) override {
    pipeline_.forward(
        device_input(input),
        {rays.origins.data(), rays.directions.data()},
        rays.origins.num_pixels(),
        cutoffs(settings),
        device_output(output)
    );
  }
  void backward(
      const TraceInput& input,
      const Rays& rays,
      const TraceSettings& settings,
      const TraceOutput& output,
      const TraceOutputGradient& dL_doutput,
      TraceGradient& g
  ) override {
    pipeline_.backward(
        device_input(input),
        {rays.origins.data(), rays.directions.data()},
        cutoffs(settings),
        device_output(output),
        device_output(dL_doutput),
        g.rays.origins.data(),
        g.rays.directions.data(),
        {g.means.data(),
         g.scales.data(),
         g.rotations.data(),
         g.opacities.data(),
         g.sh_dc.data(),
         g.sh_rest.data(),
         g.visibility.data(),
         g.half_depths.data()}
    );
  }
  std::size_t num_hits() const override { return pipeline_.num_hits(); }

 private:
  mutable TracePipeline<Exec> pipeline_{executor<Exec>()};
};

// Ops run on Exec from now on; `backend` offers its memory.
template <class Exec>
void use_executor(const DeviceBackend& backend) {
  RunKernels::template offer_runs<Exec>();
  SumKernels::template offer_sums<Exec>();
  gpu_ops.rasterizer = []() -> std::unique_ptr<GpuRasterizer> {
    return std::make_unique<RasterizerOn<Exec>>();
  };
  gpu_ops.tracer = []() -> std::unique_ptr<GpuTracer> {
    return std::make_unique<TracerOn<Exec>>();
  };
  use_gpu(backend);
}

}  // namespace glint::gpu
