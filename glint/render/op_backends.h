// SPDX-License-Identifier: MIT
// The two ops as a device implements them: the CPU (rasterize_cpu.cpp, trace_cpu.cpp) and GPUs
// (glint/cuda/ops.h). Arguments are those of Rasterizer and Tracer, checked; outputs and gradients
// have their shapes.
#pragma once

#include <memory>

#include "glint/render/rasterize.h"
#include "glint/render/trace.h"

namespace glint {

class RasterBackend {
 public:
  virtual ~RasterBackend() = default;
  // first: one on the same device whose lists may serve, see Rasterizer; or null.
  virtual void forward(const RasterCall& call, RasterOutput& output, RasterBackend* first) = 0;
  // Of the last forward call, with its output.
  virtual void backward(
      const RasterCall& call,
      const RasterOutput& output,
      const RasterOutputGradient& dL_doutput,
      RasterGradient& gradient
  ) = 0;
  virtual void first_surface(
      const RasterCall& call,
      const RasterOutput& output,
      const Image& mask,
      const FirstSurfaceSettings& settings,
      Image& depth
  ) = 0;
  virtual void depth_modes(
      const RasterCall& call, const DepthModeSettings& settings, Image& first, Image& last
  ) = 0;
  virtual std::size_t num_pairs() = 0;
  virtual std::size_t num_pixel_pairs() = 0;
};

class TraceBackend {
 public:
  virtual ~TraceBackend() = default;
  virtual void forward(const TraceCall& call, TraceOutput& output) = 0;
  virtual void backward(
      const TraceCall& call,
      const TraceOutput& output,
      const TraceOutputGradient& dL_doutput,
      TraceGradient& gradient
  ) = 0;
  virtual std::size_t num_hits() = 0;
};

std::unique_ptr<RasterBackend> raster_on_cpu();
std::unique_ptr<TraceBackend> trace_on_cpu();

// Filled by the GPU backend in use; not looked at on the CPU.
struct GpuOps {
  std::unique_ptr<RasterBackend> (*rasterizer)() = nullptr;
  std::unique_ptr<TraceBackend> (*tracer)() = nullptr;
  // Sorts keys, stably; `order`: where each was.
  void (*sort)(Array<std::uint32_t>& keys, Array<std::uint32_t>& order) = nullptr;
};
inline GpuOps gpu_ops;

// An op's implementations, made when their device is first used.
template <class Backend>
class DeviceChoice {
 public:
  using Make = std::unique_ptr<Backend> (*)();
  Backend& on(bool gpu, Make make_cpu, Make make_gpu) {
    std::unique_ptr<Backend>& chosen = gpu ? gpu_ : cpu_;
    if (chosen == nullptr) chosen = gpu ? make_gpu() : make_cpu();
    return *chosen;
  }

 private:
  std::unique_ptr<Backend> cpu_, gpu_;
};

}  // namespace glint
