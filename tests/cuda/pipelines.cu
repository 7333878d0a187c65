// SPDX-License-Identifier: MIT
// Compile test: the kernels of both accelerators as device code. Nothing is run.
#include "glint/cuda/device_exec.cuh"
#include "glint/cuda/raster_pipeline.h"
#include "glint/cuda/trace_pipeline.h"

namespace glint::gpu {

void rasterize_on_device(
    DeviceExec& exec,
    const DeviceSurfels& surfels,
    const CameraOf<float>& camera,
    const DeviceImages& images,
    const DeviceGradients& gradients
) {
  RasterPipeline<DeviceExec> pipeline(exec);
  pipeline.forward(surfels, camera, nullptr, {}, images);
  pipeline.backward(surfels, camera, images, images, gradients);
}

void trace_on_device(
    DeviceExec& exec,
    const DeviceTraceInput& input,
    const DeviceRays& rays,
    const DeviceTraceOutput& output,
    float* ray_gradients,
    const DeviceTraceGradients& gradients
) {
  TracePipeline<DeviceExec> pipeline(exec);
  const TraceCutoffs cutoffs{0, kMaxRho, kMinAlpha, kMinTransmittance, 64};
  pipeline.forward(input, rays, 1, cutoffs, output);
  pipeline.backward(input, rays, cutoffs, output, output, ray_gradients, ray_gradients, gradients);
}

}  // namespace glint::gpu
