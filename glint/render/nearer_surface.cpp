// SPDX-License-Identifier: MIT
#include "glint/render/nearer_surface.h"

#include "glint/render/nearer_surface_kernels.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 4096;  // pixels a block

template <class Maps>
SurfaceMaps maps_of(const Maps& maps) {
  return {
      maps.features.on_device(),
      maps.alpha.on_device(),
      maps.depth_sum.on_device(),
      maps.normal.on_device()};
}

template <class Maps>
SurfaceMapRefs refs_of(Maps& maps, ImageSize size, int channels) {
  fit(maps.features, size, channels);
  fit(maps.alpha, size, 1);
  fit(maps.depth_sum, size, 1);
  fit(maps.normal, size, 3);
  return {
      maps.features.on_device(),
      maps.alpha.on_device(),
      maps.depth_sum.on_device(),
      maps.normal.on_device()};
}

}  // namespace

const RasterOutput& NearerSurface::pick(
    const RasterOutput& panes, const RasterOutput& others, int transparency, const Image& light
) {
  const ImageSize size = light.size();
  const int channels = others.features.channels();
  light_ = &light;
  transparency_ = transparency;
  fit(is_pane_, size, 1);
  run_kernel(
      size.num_pixels(),
      kGrain,
      PickNearer{
          channels,
          transparency,
          maps_of(panes),
          maps_of(others),
          others.depth_median.on_device(),
          light.on_device(),
          refs_of(picked_, size, channels),
          is_pane_.on_device()}
  );
  return picked_;
}

void NearerSurface::pick_vjp(
    const RasterOutputGradient& dL_dpicked,
    RasterOutputGradient& dL_dpanes,
    RasterOutputGradient& dL_dothers
) const {
  const ImageSize size = is_pane_.size();
  const int channels = picked_.features.channels();
  run_kernel(
      size.num_pixels(),
      kGrain,
      PickNearerVjp{
          channels,
          transparency_,
          is_pane_.on_device(),
          light_->on_device(),
          maps_of(dL_dpicked),
          refs_of(dL_dpanes, size, channels),
          refs_of(dL_dothers, size, channels)}
  );
}

}  // namespace glint
