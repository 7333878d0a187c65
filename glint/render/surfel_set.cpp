// SPDX-License-Identifier: MIT
#include "glint/render/surfel_set.h"

#include <cmath>

#include "glint/core/error.h"
#include "glint/core/kernel.h"
#include "glint/render/map_kernels.h"

namespace glint {

const RasterOutput& SurfelSet::forward(
    RasterPass& pass,
    const Camera& camera,
    int sh_degree,
    const RasterSettings& settings,
    BorrowedImage near_limit
) const {
  pass.sh_degree = sh_degree;
  pass.of_first = nullptr;
  activate(cloud_, cast<float>(camera.center()), sh_degree, pass.activated);
  RasterCall call{raster_input(cloud_, pass.activated), camera, settings};
  call.input.near_limit = near_limit;
  return pass.rasterizer.forward(call);
}

const RasterOutput& SurfelSet::forward_again(
    RasterPass& pass,
    RasterPass& first,
    const RasterSettings& settings,
    BorrowedImage needed,
    BorrowedImage near_limit
) const {
  pass.sh_degree = first.sh_degree;
  pass.of_first = &first.used();
  RasterCall call{raster_input(cloud_, pass.used()), first.rasterizer.call().camera, settings};
  call.input.needed = needed;
  call.input.near_limit = near_limit;
  return pass.rasterizer.forward(call, &first.rasterizer);
}

const TraceOutput& SurfelSet::trace(
    TracePass& pass, const Rays& rays, int sh_degree, const TraceSettings& settings
) const {
  activate_geometry(cloud_, pass.activated);
  return pass.tracer.forward({trace_input(cloud_, pass.activated, sh_degree), rays, settings});
}

const RasterGradient& raster_backward(
    const SurfelCloud& cloud,
    RasterPass& pass,
    const RasterOutputGradient& dL_doutput,
    SurfelCloud& dL_dcloud
) {
  const RasterGradient& gradient = pass.rasterizer.backward(dL_doutput);
  const Vec3f eye = cast<float>(pass.rasterizer.call().camera.center());
  activate_vjp(cloud, eye, pass.sh_degree, pass.used(), gradient, dL_dcloud);
  return gradient;
}

const TraceGradient& trace_backward(
    TracePass& pass, const TraceOutputGradient& dL_doutput, SurfelCloud& dL_dcloud
) {
  const TraceGradient& gradient = pass.tracer.backward(dL_doutput);
  trace_activate_vjp(pass.activated, gradient, dL_dcloud);
  return gradient;
}

bool is_finite(const FloatArray& values) {
  constexpr int kRow = 1024;
  const int rows = static_cast<int>((values.size() + kRow - 1) / kRow);
  return sum_kernel({kRow, rows}, CountNotFinite{values.on_device(), values.size(), kRow}) == 0;
}

void check_finite(const SurfelCloud& cloud, const std::string& set_name) {
  cloud.for_each_array([&](const char* name, const FloatArray& array, std::size_t width) {
    if (on_gpu() && is_finite(array)) return;
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

}  // namespace glint
