// SPDX-License-Identifier: MIT
#include "glint/render/trace.h"

#include "glint/core/error.h"
#include "glint/render/gpu_ops.h"
#include "glint/render/trace_saved.h"

namespace glint {

struct Tracer::Backends {
  TraceSaved cpu;
  std::unique_ptr<GpuTracer> gpu;  // once the GPU was in use

  GpuTracer& on_gpu() {
    if (gpu == nullptr) gpu = gpu_ops.tracer();
    return *gpu;
  }
};

namespace {

void check_arguments(const TraceInput& input, const Rays& rays) {
  const std::size_t n = input.count;
  const bool sizes_agree = input.means.size() == 3 * n && input.scales.size() == 2 * n &&
                           input.rotations.size() == 4 * n && input.opacities.size() == n &&
                           input.sh_dc.size() == 3 * n && input.sh_rest.size() == 45 * n;
  GLINT_CHECK(sizes_agree, kUsage, "trace: array sizes do not match {} surfels", n);
  GLINT_CHECK(
      rays.origins.size() == rays.directions.size() && rays.origins.channels() == 3 &&
          rays.directions.channels() == 3,
      kUsage,
      "trace: origins are {}x{}x{}, directions {}x{}x{}, expected two images of 3 channels",
      rays.origins.width(),
      rays.origins.height(),
      rays.origins.channels(),
      rays.directions.width(),
      rays.directions.height(),
      rays.directions.channels()
  );
}

void fit_output(ImageSize size, TraceOutput& out) {
  fit(out.color, size, 3);
  fit(out.normal, size, 3);
  fit(out.alpha, size, 1);
  fit(out.depth_sum, size, 1);
}

void fit_gradient(const TraceInput& input, ImageSize size, TraceGradient& out) {
  const std::size_t n = input.count;
  out.means.resize(3 * n);
  out.scales.resize(2 * n);
  out.rotations.resize(4 * n);
  out.opacities.resize(n);
  out.sh_dc.resize(3 * n);
  out.sh_rest.resize(45 * n);
  out.visibility.resize(n);
  out.half_depths.resize(3 * n);
  fit(out.rays.origins, size, 3);
  fit(out.rays.directions, size, 3);
}

}  // namespace

Tracer::Tracer() : backends_(std::make_unique<Backends>()) {}
Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;
Tracer& Tracer::operator=(Tracer&&) noexcept = default;

std::size_t Tracer::num_hits() const {
  return on_gpu() ? backends_->on_gpu().num_hits() : trace_num_hits(backends_->cpu);
}

void Tracer::forward(
    const TraceInput& input, const Rays& rays, const TraceSettings& settings, TraceOutput& output
) {
  check_arguments(input, rays);
  fit_output(rays.origins.size(), output);
  if (on_gpu())
    backends_->on_gpu().forward(input, rays, settings, output);
  else
    trace_forward_cpu(input, rays, settings, output, backends_->cpu);
}

void Tracer::backward(
    const TraceInput& input,
    const Rays& rays,
    const TraceSettings& settings,
    const TraceOutput& output,
    const TraceOutputGradient& dL_doutput,
    TraceGradient& gradient
) {
  check_arguments(input, rays);
  fit_gradient(input, rays.origins.size(), gradient);
  if (on_gpu())
    backends_->on_gpu().backward(input, rays, settings, output, dL_doutput, gradient);
  else
    trace_backward_cpu(input, rays, output, dL_doutput, gradient, backends_->cpu);
}

}  // namespace glint
