// SPDX-License-Identifier: MIT
#include "glint/train/normal_consistency.h"

#include "glint/core/kernel.h"
#include "glint/train/check_fits.h"
#include "glint/train/normal_kernels.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 1024;  // pixels a block

}  // namespace

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
  const Unprojector unproject = unprojector(camera, depth);
  const auto num_pixels = static_cast<double>(depth.num_pixels());
  fit(dL_dx_, depth.size(), 3);
  fit(dL_dy_, depth.size(), 3);
  const NormalConsistencyAt loss_at{
      unproject,
      normal,
      alpha,
      pixel_weight,
      weight / static_cast<float>(depth.num_pixels()),
      dL_dnormal.ref(),
      dL_dx_.ref(),
      dL_dy_.ref()};
  const double loss = sum_kernel(depth.size(), loss_at) / num_pixels;
  run_kernel(
      depth.num_pixels(),
      kGrain,
      ConsistencyDepthVjp{unproject, dL_dx_.view(), dL_dy_.view(), dL_ddepth.ref()}
  );
  return loss;
}

Image NormalConsistencyLoss::depth_normals(const Camera& camera, const Image& depth) {
  Image normals(depth.width(), depth.height(), 3);
  const Unprojector unproject = unprojector(camera, depth);
  synchronize();
  for (int y = 0; y < depth.height(); ++y)
    for (int x = 0; x < depth.width(); ++x) {
      const DepthDifferences d = differences_at(unproject, x, y);
      if (d.valid) add3(normals.ref(), x, y, normal_from_differences(d.right_left, d.down_up));
    }
  return normals;
}

}  // namespace glint
