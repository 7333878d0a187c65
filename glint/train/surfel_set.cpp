// SPDX-License-Identifier: MIT
#include "glint/train/surfel_set.h"

#include <cmath>

#include "glint/core/error.h"
#include "glint/core/kernel.h"
#include "glint/train/map_kernels.h"

namespace glint {

namespace {
constexpr std::size_t kPixelGrain = 4096;  // pixels a block
}

SurfelSet::SurfelSet(
    SurfelCloud cloud, SurfelRates rates, DensifyConfig densify, float extent, std::uint64_t seed
)
    : cloud_(std::move(cloud)), rates_(rates), extent_(extent), densifier_(densify, extent, seed) {
  gradient_.extra_names = cloud_.extra_names;
  gradient_.resize(cloud_.size());
}

const RasterOutput& SurfelSet::forward(
    const Camera& camera,
    int sh_degree,
    const RasterSettings& settings,
    ImageView near_limit,
    RasterPass& pass
) const {
  activate(cloud_, cast<float>(camera.center()), sh_degree, pass.activated);
  RasterInput input = raster_input(cloud_, pass.activated);
  input.near_limit = near_limit;
  pass.rasterizer.forward(input, camera, settings, pass.output);
  return pass.output;
}

void SurfelSet::backward(
    const Camera& camera,
    int sh_degree,
    const RasterSettings& settings,
    const RasterOutputGradient& dL_doutput,
    ImageView near_limit,
    RasterPass& pass
) {
  RasterInput input = raster_input(cloud_, pass.activated);
  input.near_limit = near_limit;
  pass.rasterizer.backward(input, camera, settings, pass.output, dL_doutput, pass.gradient);
  activate_vjp(
      cloud_, cast<float>(camera.center()), sh_degree, pass.activated, pass.gradient, gradient_
  );
}

const RasterOutput& SurfelSet::forward(
    const Camera& camera, int sh_degree, const RasterSettings& settings, ImageView near_limit
) {
  return forward(camera, sh_degree, settings, near_limit, pass_);
}

void SurfelSet::backward(
    const Camera& camera,
    int sh_degree,
    const RasterSettings& settings,
    const RasterOutputGradient& dL_doutput,
    ImageView near_limit
) {
  backward(camera, sh_degree, settings, dL_doutput, near_limit, pass_);
  densifier_.observe(pass_.output, pass_.gradient);
}

const TraceOutput& SurfelSet::trace(
    const Rays& rays, int sh_degree, const TraceSettings& settings
) {
  activate_geometry(cloud_, traced_);
  tracer_.forward(trace_input(cloud_, traced_, sh_degree), rays, settings, trace_output_);
  return trace_output_;
}

const Rays& SurfelSet::trace_backward(
    const Rays& rays,
    int sh_degree,
    const TraceSettings& settings,
    const TraceOutputGradient& dL_doutput
) {
  tracer_.backward(
      trace_input(cloud_, traced_, sh_degree),
      rays,
      settings,
      trace_output_,
      dL_doutput,
      trace_gradient_
  );
  trace_activate_vjp(traced_, trace_gradient_, gradient_);
  densifier_.observe(trace_gradient_, rays.origins.height());
  return trace_gradient_.rays;
}

void SurfelSet::freeze_geometry() {
  frozen_geometry_ = true;
  rates_.means = rates_.means_final = 0;
  rates_.scale = rates_.rotation = rates_.opacity = 0;
}

DensifyCounts SurfelSet::update(int step) {
  adam_.step(cloud_, gradient_, rates_, extent_);
  const DensifyCounts counts =
      frozen_geometry_ ? DensifyCounts{} : densifier_.update(step, cloud_, adam_);
  gradient_.resize(cloud_.size());  // zero after every step
  return counts;
}

void check_finite(const SurfelCloud& cloud, const std::string& set_name) {
  cloud.for_each_array([&](const char* name, const FloatArray& array, std::size_t width) {
    for (std::size_t i = 0; i < array.size(); ++i)
      GLINT_CHECK(
          std::isfinite(array[i]),
          kBadPrediction,
          "{}: {} of surfel {} is {}; lower the learning rate of that parameter",
          set_name,
          name,
          i / width,
          array[i]
      );
  });
}

void expected_depth_map(const RasterOutput& output, Image& depth) {
  fit(depth, output.alpha.size(), 1);
  run_kernel(
      depth.num_pixels(),
      kPixelGrain,
      ExpectedDepth{output.depth_sum.data(), output.alpha.data(), depth.data()}
  );
}

void expected_depth_map_vjp(
    const RasterOutput& output, const Image& dL_ddepth, RasterOutputGradient& dL_doutput
) {
  run_kernel(
      dL_ddepth.num_pixels(),
      kPixelGrain,
      ExpectedDepthVjp{
          output.depth_sum.data(),
          output.alpha.data(),
          dL_ddepth.data(),
          dL_doutput.depth_sum.data(),
          dL_doutput.alpha.data()}
  );
}

void clear_image(Image& image, ImageSize size, int channels) {
  fit(image, size, channels);
  fill(image.data(), image.values().size(), 0.0f);
}

void clear_gradient(ImageSize size, int features, RasterOutputGradient& dL_doutput) {
  clear_image(dL_doutput.features, size, features);
  clear_image(dL_doutput.normal, size, 3);
  clear_image(dL_doutput.alpha, size, 1);
  clear_image(dL_doutput.depth_sum, size, 1);
}

Image unit_normals(const Image& normal) {
  Image result(normal.width(), normal.height(), 3);
  run_kernel(normal.num_pixels(), kPixelGrain, UnitNormals{normal.data(), result.data()});
  return result;
}

}  // namespace glint
