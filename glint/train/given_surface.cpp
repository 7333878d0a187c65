// SPDX-License-Identifier: MIT
#include "glint/train/given_surface.h"

#include "glint/render/map_ops.h"
#include "glint/train/check_fits.h"
#include "glint/train/given_surface_kernels.h"

namespace glint {

namespace {
constexpr std::size_t kGrain = 4096;  // pixels a block
}

const RasterOutput& GivenSurface::put(
    const RasterOutput& interface, const MapSet& truth, int transparency
) {
  const ImageSize size = interface.alpha.size();
  check_fits("true depth", truth["depth"], size, 1);
  check_fits("true normals", truth["normal"], size, 3);
  check_fits("glass mask", truth["glass"], size, 1);
  transparency_ = transparency;
  const int channels = interface.features.channels();
  fit(surface_.features, size, channels);
  fit(surface_.alpha, size, 1);
  fit(surface_.depth_sum, size, 1);
  surface_.normal = truth["normal"];
  run_kernel(
      size.num_pixels(),
      kGrain,
      PutSurface{
          channels,
          transparency,
          interface.features.on_device(),
          truth["depth"].on_device(),
          truth["glass"].on_device(),
          surface_.features.on_device(),
          surface_.alpha.on_device(),
          surface_.depth_sum.on_device()}
  );
  return surface_;
}

RasterOutputGradient& GivenSurface::gradient() {
  clear_gradient(surface_.alpha.size(), surface_.features.channels(), gradient_);
  return gradient_;
}

void GivenSurface::put_vjp(RasterOutputGradient& dL_dinterface) {
  run_kernel(
      surface_.alpha.num_pixels(),
      kGrain,
      PutSurfaceVjp{
          surface_.features.channels(),
          transparency_,
          gradient_.features.on_device(),
          dL_dinterface.features.on_device()}
  );
}

}  // namespace glint
