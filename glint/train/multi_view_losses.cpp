// SPDX-License-Identifier: MIT
#include "glint/train/multi_view_losses.h"

#include "glint/core/kernel.h"
#include "glint/train/check_fits.h"
#include "glint/train/multi_view_kernels.h"

namespace glint {

namespace {

constexpr std::size_t kPixelGrain = 4096;  // pixels a block

void add_scaled(const Image& values, double scale, Image& out) {
  run_kernel(
      values.values().size(),
      kPixelGrain,
      AddScaled{values.data(), static_cast<float>(scale), out.data()}
  );
}

// Which pixels of `count` are drawn where `wanted` are enough.
PixelSample sample_of(double count, std::size_t wanted, std::uint32_t seed) {
  if (count <= static_cast<double>(wanted)) return {seed};
  return {seed, static_cast<std::uint32_t>(4294967296.0 * static_cast<double>(wanted) / count)};
}

}  // namespace

double MultiViewLosses::geometric(
    const PlanarView& reference,
    const PlanarView& neighbor,
    float weight,
    Image& dL_ddepth,
    Image& dL_dneighbor_depth,
    MultiViewTerms& terms
) {
  const ImageSize size = reference.depth.size();
  fit(weight_, size, 1);
  fit(depth_gradient_, size, 1);
  const std::size_t neighbor_pixels = neighbor.depth.num_pixels();
  if (neighbor_gradient_.size() != neighbor_pixels) neighbor_gradient_.assign(neighbor_pixels, 0);
  const FixedSums neighbor_sums{neighbor_gradient_.data()};
  const CountedSum sum = sum_kernel(
      size,
      ReprojectionAt<float>{
          camera_pair<float>(reference.camera, neighbor.camera),
          reference.depth,
          neighbor.depth,
          settings.min_z,
          settings.max_error,
          weight_.ref(),
          depth_gradient_.ref(),
          neighbor_sums}
  );
  terms.geometric = sum.mean();
  terms.num_pixels = sum.count;
  if (sum.count == 0) return 0;
  const double scale = static_cast<double>(weight) / sum.count;
  add_scaled(depth_gradient_, scale, dL_ddepth);
  run_kernel(
      neighbor_pixels, kPixelGrain, AddFixed{neighbor_sums, scale, dL_dneighbor_depth.data()}
  );
  return sum.count;
}

MultiViewTerms MultiViewLosses::evaluate(
    const PlanarView& reference,
    const PlanarView& neighbor,
    const Image& normal,
    const Image& distance,
    MultiViewWeights weights,
    std::uint32_t seed,
    Image& dL_ddepth,
    Image& dL_dneighbor_depth,
    Image& dL_dnormal,
    Image& dL_ddistance
) {
  const ImageSize size = reference.depth.size();
  check_fits("photo of the reference view", reference.gray, size, 1);
  check_fits("photo of the neighbour", neighbor.gray, neighbor.depth.size(), 1);
  MultiViewTerms terms;
  const double count =
      geometric(reference, neighbor, weights.geometric, dL_ddepth, dL_dneighbor_depth, terms);
  if (count == 0 || weights.photometric == 0) return terms;
  fit(normal_gradient_, size, 3);
  fit(distance_gradient_, size, 1);
  const CountedSum sum = sum_kernel(
      size,
      PatchSimilarityAt<float>{
          camera_pair<float>(reference.camera, neighbor.camera),
          reference.gray,
          neighbor.gray,
          normal,
          distance,
          weight_,
          sample_of(count, settings.max_patches, seed),
          settings.max_dissimilarity,
          normal_gradient_.ref(),
          distance_gradient_.ref()}
  );
  terms.photometric = sum.mean();
  terms.num_patches = sum.count;
  if (sum.count == 0) return terms;
  const double scale = static_cast<double>(weights.photometric) / sum.count;
  add_scaled(normal_gradient_, scale, dL_dnormal);
  add_scaled(distance_gradient_, scale, dL_ddistance);
  return terms;
}

Image gray_of(const Image& rgb) {
  Image gray(rgb.width(), rgb.height(), 1);
  for (std::size_t i = 0; i < gray.num_pixels(); ++i) {
    const float* c = rgb.data() + 3 * i;
    gray.data()[i] = 0.299f * c[0] + 0.587f * c[1] + 0.114f * c[2];
  }
  return gray;
}

}  // namespace glint
