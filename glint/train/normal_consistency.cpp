// SPDX-License-Identifier: MIT
#include "glint/train/normal_consistency.h"

#include "glint/core/kernel.h"
#include "glint/train/check_fits.h"
#include "glint/train/normal_kernels.h"

namespace glint {

double NormalConsistencyLoss::evaluate(
    const Camera& camera,
    const Image& normal,
    const Image& depth,
    const Image& alpha,
    float weight,
    Image& dL_dnormal,
    Image& dL_ddepth,
    const Image& pixel_weight
) {
  if (!pixel_weight.empty())
    check_fits("weights of normal consistency", pixel_weight, depth.size(), 1);
  const auto evaluate = [&](auto& loss, const Image& opacity, const Image& factors) {
    return loss.evaluate(camera, normal, depth, opacity, factors, weight, dL_dnormal, dL_ddepth);
  };
  if (!cosine)
    return unit_normals ? evaluate(of_units_, alpha, pixel_weight)
                        : evaluate(loss_, alpha, pixel_weight);
  fit(ones_, depth.size(), 1);
  ones_.array().fill(1);
  return evaluate(of_units_, ones_, shares(camera, depth, pixel_weight));
}

const Image& NormalConsistencyLoss::shares(
    const Camera& camera, const Image& depth, const Image& pixel_weight
) {
  constexpr std::size_t kGrain = 1024;  // pixels a block
  const SumConsistentWeights weights{
      unprojector(camera, depth.on_device()), pixel_weight.on_device()};
  sum_kernel_to(depth.size(), weights, weight_sum_);
  fit(shares_, depth.size(), 1);
  run_kernel(
      depth.num_pixels(),
      kGrain,
      ShareConsistentWeights{weights, weight_sum_.on_device(), shares_.on_device()}
  );
  return shares_;
}

Image NormalConsistencyLoss::depth_normals(const Camera& camera, const Image& depth) {
  Image normals(depth.width(), depth.height(), 3);
  const Unprojector unproject = unprojector(camera, depth.view());
  for (int y = 0; y < depth.height(); ++y)
    for (int x = 0; x < depth.width(); ++x) {
      const DepthDifferences d = differences_at(unproject, x, y);
      if (d.valid) add3(normals.ref(), x, y, normal_from_differences(d.right_left, d.down_up));
    }
  return normals;
}

}  // namespace glint
