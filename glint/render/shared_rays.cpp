// SPDX-License-Identifier: MIT
#include "glint/render/shared_rays.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 4096;  // pixels a block

// Not the step itself, which would give every view the same pixels each time.
LeaderOfBlock leader_at(const ShareBlocks& blocks, int step) {
  const std::uint32_t mixed = static_cast<std::uint32_t>(step) * 2654435761u >> 16;
  constexpr auto kSide = static_cast<std::uint32_t>(ShareBlocks::kSide);
  return {blocks, static_cast<int>(mixed % kSide), static_cast<int>(mixed / kSide % kSide)};
}

}  // namespace

SharersOf SharedRays::sharers() const { return {blocks_, source_.on_device()}; }

const Rays& SharedRays::choose(const GlassBuffer& buffer, const RaySharing& sharing, int step) {
  const ImageSize size = buffer.depth.size();
  blocks_ = {size.width, size.height};
  rays_.origins = buffer.reflected.origins;
  fit(rays_.directions, size, 3);
  source_.resize(size.num_pixels());
  run_kernel(
      size.num_pixels(),
      kGrain,
      ShareRays{
          leader_at(blocks_, step),
          sharing,
          buffer.specularity.on_device(),
          buffer.transparency.on_device(),
          buffer.normal.on_device(),
          buffer.reflected.directions.on_device(),
          source_.on_device(),
          rays_.directions.on_device()}
  );
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
