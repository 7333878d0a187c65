// SPDX-License-Identifier: MIT
#include "glint/render/rasterize.h"

#include "glint/core/error.h"
#include "glint/render/gpu_ops.h"
#include "glint/render/pixel_pass.h"
#include "glint/render/raster_saved.h"

namespace glint {

struct Rasterizer::Backends {
  RasterSaved cpu;
  std::unique_ptr<GpuRasterizer> gpu;  // once the GPU was in use

  GpuRasterizer& on_gpu() {
    if (gpu == nullptr) gpu = gpu_ops.rasterizer();
    return *gpu;
  }
};

namespace {

void check_input(const RasterInput& input, const Camera& camera) {
  GLINT_CHECK(
      input.channels >= 1 && input.channels <= kMaxChannels,
      kUsage,
      "rasterize: {} feature channels, expected 1 to {}",
      input.channels,
      kMaxChannels
  );
  const std::size_t n = input.count;
  const bool sizes_agree = input.means.size() == 3 * n && input.scales.size() == 2 * n &&
                           input.rotations.size() == 4 * n && input.opacities.size() == n &&
                           input.features.size() == n * input.channels;
  GLINT_CHECK(sizes_agree, kUsage, "rasterize: array sizes do not match {} surfels", n);
  GLINT_CHECK(
      input.near_limit.empty() || input.near_limit.size() == camera.size(),
      kUsage,
      "rasterize: near_limit is {}x{}, the camera {}x{}",
      input.near_limit.width,
      input.near_limit.height,
      camera.width,
      camera.height
  );
}

void fit_outputs(
    const RasterInput& input, const RasterSettings& settings, ImageSize size, RasterOutput& out
) {
  fit(out.features, size, input.channels);
  fit(out.normal, size, 3);
  for (Image* image : {&out.alpha, &out.depth_sum, &out.depth_median}) fit(*image, size, 1);
  out.visibility.resize(input.count);
  out.in_view.resize(input.count);
  if (settings.with_distortion)
    fit(out.distortion, size, 1);
  else
    out.distortion = Image();
}

void fit_gradient(const RasterInput& input, RasterGradient& gradient) {
  const std::size_t n = input.count;
  gradient.means.resize(3 * n);
  gradient.scales.resize(2 * n);
  gradient.rotations.resize(4 * n);
  gradient.opacities.resize(n);
  gradient.features.resize(n * input.channels);
  gradient.screen.resize(2 * n);
}

}  // namespace

Rasterizer::Rasterizer() : backends_(std::make_unique<Backends>()) {}
Rasterizer::~Rasterizer() = default;
Rasterizer::Rasterizer(Rasterizer&&) noexcept = default;
Rasterizer& Rasterizer::operator=(Rasterizer&&) noexcept = default;

std::size_t Rasterizer::num_pairs() const {
  return on_gpu() ? backends_->on_gpu().num_pairs() : backends_->cpu.lists.num_pairs();
}

std::size_t Rasterizer::num_pixel_pairs() const {
  return on_gpu() ? backends_->on_gpu().num_pixel_pairs() : raster_pixel_pairs(backends_->cpu);
}

void Rasterizer::forward(
    const RasterInput& input,
    const Camera& camera,
    const RasterSettings& settings,
    RasterOutput& output,
    bool scalar
) {
  check_input(input, camera);
  fit_outputs(input, settings, camera.size(), output);
  if (on_gpu())
    backends_->on_gpu().forward(input, camera, settings, output);
  else
    rasterize_forward_cpu(input, camera, settings, output, scalar, backends_->cpu);
}

void Rasterizer::backward(
    const RasterInput& input,
    const Camera& camera,
    const RasterSettings& settings,
    const RasterOutput& output,
    const RasterOutputGradient& dL_doutput,
    RasterGradient& gradient,
    bool scalar
) {
  check_input(input, camera);
  fit_gradient(input, gradient);
  if (on_gpu())
    backends_->on_gpu().backward(input, camera, settings, output, dL_doutput, gradient);
  else
    rasterize_backward_cpu(
        input, camera, settings, output, dL_doutput, gradient, scalar, backends_->cpu
    );
}

}  // namespace glint
