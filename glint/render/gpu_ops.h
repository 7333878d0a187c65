// SPDX-License-Identifier: MIT
// The two ops as a GPU backend implements them (glint/cuda/ops.h). Arguments are those of
// Rasterizer and Tracer, checked; outputs and gradients have their shapes.
#pragma once

#include <memory>

#include "glint/render/rasterize.h"
#include "glint/render/trace.h"

namespace glint {

class GpuRasterizer {
 public:
  virtual ~GpuRasterizer() = default;
  virtual void forward(
      const RasterInput& input,
      const Camera& camera,
      const RasterSettings& settings,
      RasterOutput& output
  ) = 0;
  virtual void backward(
      const RasterInput& input,
      const Camera& camera,
      const RasterSettings& settings,
      const RasterOutput& output,
      const RasterOutputGradient& dL_doutput,
      RasterGradient& gradient
  ) = 0;
  virtual std::size_t num_pairs() const = 0;
  virtual std::size_t num_pixel_pairs() const = 0;
};

class GpuTracer {
 public:
  virtual ~GpuTracer() = default;
  virtual void forward(
      const TraceInput& input, const Rays& rays, const TraceSettings& settings, TraceOutput& output
  ) = 0;
  virtual void backward(
      const TraceInput& input,
      const Rays& rays,
      const TraceSettings& settings,
      const TraceOutput& output,
      const TraceOutputGradient& dL_doutput,
      TraceGradient& gradient
  ) = 0;
  virtual std::size_t num_hits() const = 0;
};

// Filled by the backend in use; not looked at on the CPU.
struct GpuOps {
  std::unique_ptr<GpuRasterizer> (*rasterizer)() = nullptr;
  std::unique_ptr<GpuTracer> (*tracer)() = nullptr;
};
inline GpuOps gpu_ops;

}  // namespace glint
