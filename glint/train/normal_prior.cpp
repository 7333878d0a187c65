// SPDX-License-Identifier: MIT
#include "glint/train/normal_prior.h"

#include <algorithm>
#include <iterator>

#include "glint/core/kernel.h"
#include "glint/render/op_backends.h"
#include "glint/train/check_fits.h"
#include "glint/train/normal_kernels.h"
#include "glint/train/share_kernels.h"

namespace glint {

namespace {

constexpr std::size_t kGrain = 4096;  // pixels a block

DepthRange central_range(const Image& depth) {
  std::vector<float> depths;
  std::copy_if(
      depth.values().begin(),
      depth.values().end(),
      std::back_inserter(depths),
      [](float z) { return z > 0; }
  );
  if (depths.empty()) return {};
  const auto tail = static_cast<std::ptrdiff_t>(DepthRange::tail(depths.size()));
  const auto quantile = [&](std::ptrdiff_t rank) {
    std::nth_element(depths.begin(), depths.begin() + rank, depths.end());
    return depths[rank];
  };
  return {quantile(tail), quantile(static_cast<std::ptrdiff_t>(depths.size()) - 1 - tail)};
}

void find_range_on_gpu(const Image& depth, Array<DepthRange>& range) {
  Array<std::uint32_t> keys(depth.num_pixels()), order;
  run_kernel(keys.size(), kGrain, DepthKeys{depth.on_device(), keys.on_device()});
  gpu_ops.sort(keys, order);
  run_kernel(1, 1, FindDepthRange{std::as_const(keys).on_device(), keys.size(), range.on_device()});
}

}  // namespace

template <class T>
double NormalPriorLoss::evaluate(
    const BasicImage<T>& normal,
    const Image& prior,
    const Image& pixel_weight,
    T weight,
    BasicImage<T>& dL_dnormal
) const {
  if (prior.empty()) return 0;
  check_fits("normal prior", prior, normal.size(), 3);
  if (!pixel_weight.empty())
    check_fits("weights of the normal prior", pixel_weight, normal.size(), 1);
  const ImageView counted = weighted_mean ? pixel_weight.on_device() : ImageView{};
  Array<double> divisor;
  Array<T> scale;
  sum_kernel_to(normal.size(), SumPriorWeights{prior.on_device(), counted}, divisor);
  share_of(divisor.on_device(), weight, scale);
  const NormalPriorAt<T> loss_at{
      normal.on_device(),
      prior.on_device(),
      pixel_weight.on_device(),
      static_cast<T>(min_cosine),
      static_cast<T>(l1),
      scale.on_device(),
      dL_dnormal.on_device()};
  const double sum = sum_kernel(normal.size(), loss_at), count = told(divisor);
  return count == 0 ? 0 : sum / count;
}

Image inverse_depth_weight(const Image& depth) {
  Array<DepthRange> range(1);
  if (on_gpu())
    find_range_on_gpu(depth, range);
  else
    range[0] = central_range(depth);
  Image weights(depth.width(), depth.height(), 1);
  run_kernel(
      depth.num_pixels(),
      kGrain,
      WeighByDepth{depth.on_device(), range.on_device(), weights.on_device()}
  );
  return weights;
}

template double NormalPriorLoss::evaluate(const Image&, const Image&, const Image&, float, Image&)
    const;
template double NormalPriorLoss::
    evaluate(const BasicImage<double>&, const Image&, const Image&, double, BasicImage<double>&)
        const;

}  // namespace glint
