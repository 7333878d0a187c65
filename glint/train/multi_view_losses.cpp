// SPDX-License-Identifier: MIT
#include "glint/train/multi_view_losses.h"

#include "glint/core/kernel.h"
#include "glint/train/check_fits.h"
#include "glint/train/share_kernels.h"

namespace glint {

namespace {

constexpr std::size_t kPixelGrain = 4096;  // pixels a block

void add_scaled(const Image& values, const Array<double>& scale, Image& out) {
  run_kernel(
      values.num_pixels() * static_cast<std::size_t>(values.channels()),
      kPixelGrain,
      AddScaled{values.on_device(), scale.on_device(), out.on_device()}
  );
}

// What of the pixels that count each gradient is multiplied by.
void share_of_counted(const Array<CountedSum>& sum, float weight, Array<double>& scale) {
  share_of(&sum.device_for_reading()->count, static_cast<double>(weight), scale);
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
  const FixedSums neighbor_sums{neighbor_gradient_.on_device()};
  sum_kernel_to(
      size,
      ReprojectionAt<float>{
          camera_pair<float>(reference.camera, neighbor.camera),
          reference.depth.on_device(),
          neighbor.depth.on_device(),
          settings.min_z,
          settings.max_error,
          weight_.on_device(),
          depth_gradient_.on_device(),
          neighbor_sums},
      geometric_
  );
  const CountedSum sum = told(geometric_);
  terms.geometric = sum.mean();
  terms.num_pixels = sum.count;
  share_of_counted(geometric_, weight, scale_);
  add_scaled(depth_gradient_, scale_, dL_ddepth);
  run_kernel(
      neighbor_pixels,
      kPixelGrain,
      AddFixed{neighbor_sums, scale_.on_device(), dL_dneighbor_depth.on_device()}
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
  sample_.resize(1);
  run_kernel(
      1, 1, SampleOf{geometric_.on_device(), settings.max_patches, seed, sample_.on_device()}
  );
  sum_kernel_to(
      size,
      PatchSimilarityAt<float>{
          camera_pair<float>(reference.camera, neighbor.camera),
          reference.gray.on_device(),
          neighbor.gray.on_device(),
          normal.on_device(),
          distance.on_device(),
          weight_.on_device(),
          sample_.on_device(),
          settings.max_dissimilarity,
          normal_gradient_.on_device(),
          distance_gradient_.on_device()},
      photometric_
  );
  const CountedSum sum = told(photometric_);
  terms.photometric = sum.mean();
  terms.num_patches = sum.count;
  share_of_counted(photometric_, weights.photometric, scale_);
  add_scaled(normal_gradient_, scale_, dL_dnormal);
  add_scaled(distance_gradient_, scale_, dL_ddistance);
  return terms;
}

Image gray_of(const Photo& photo) {
  const Image& rgb = photo.rgb;
  Image gray(rgb.width(), rgb.height(), 1);
  for (std::size_t i = 0; i < gray.num_pixels(); ++i) {
    const float* c = rgb.data() + 3 * i;
    const bool counts = photo.all_count() || photo.counted.data()[i] != 0;
    gray.data()[i] = counts ? 0.299f * c[0] + 0.587f * c[1] + 0.114f * c[2] : kNoGray;
  }
  return gray;
}

}  // namespace glint
