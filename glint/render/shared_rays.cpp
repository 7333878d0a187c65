// SPDX-License-Identifier: MIT
#include "glint/render/shared_rays.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 4096;  // pixels a block

// Not the step itself, which would give every view the same pixels each time.
LeaderOfBlock leader_at(ImageSize size, int step) {
  const std::uint32_t mixed = static_cast<std::uint32_t>(step) * 2654435761u >> 16;
  return {
      size.width,
      size.height,
      static_cast<int>(mixed % kShareBlock),
      static_cast<int>(mixed / kShareBlock % kShareBlock)};
}

}  // namespace

SharersOf SharedRays::sharers() const {
  return {rays_.directions.width(), rays_.directions.height(), source_.on_device()};
}

const Rays& SharedRays::choose(
    const GlassBuffer& buffer, const RaySharing& sharing, const RayStops& stops, int step
) {
  const ImageSize size = buffer.depth.size();
  rays_.origins = buffer.reflected.origins;
  fit(rays_.directions, size, 3);
  source_.resize(size.num_pixels());
  run_kernel(
      size.num_pixels(),
      kGrain,
      ShareRays{
          leader_at(size, step),
          sharing,
          buffer.specularity.on_device(),
          buffer.transparency.on_device(),
          buffer.normal.on_device(),
          buffer.reflected.directions.on_device(),
          source_.on_device(),
          rays_.directions.on_device()}
  );
  if (stops.weight_below > 0) {
    fit(rays_.stops, size, 1);
    run_kernel(
        size.num_pixels(),
        kGrain,
        StopRays{sharers(), stops, buffer.specularity.on_device(), rays_.stops.on_device()}
    );
  } else {
    rays_.stops = {};
  }
  return rays_;
}

void SharedRays::spread(const Image& traced, Image& color) const {
  fit(color, traced.size(), 3);
  run_kernel(
      color.num_pixels(),
      kGrain,
      SpreadColor{source_.on_device(), traced.on_device(), color.on_device()}
  );
}

void SharedRays::spread_vjp(const Image& dL_dcolor, Image& dL_dtraced) const {
  fit(dL_dtraced, dL_dcolor.size(), 3);
  run_kernel(
      dL_dcolor.num_pixels(),
      kGrain,
      SpreadColorVjp{sharers(), dL_dcolor.on_device(), dL_dtraced.on_device()}
  );
}

}  // namespace glint
