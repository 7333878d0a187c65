// SPDX-License-Identifier: MIT
#include "glint/train/normal_prior.h"

#include <algorithm>
#include <iterator>

#include "glint/train/pixel_sums.h"

namespace glint {

namespace {

struct DepthRange {
  float near = 0, far = 0;
};
// The depths that 1 % of the pixels with depth fall short of and exceed.
DepthRange central_range(const Image& depth) {
  std::vector<float> depths;
  std::copy_if(
      depth.values().begin(),
      depth.values().end(),
      std::back_inserter(depths),
      [](float z) { return z > 0; }
  );
  if (depths.empty()) return {};
  const auto tail = static_cast<std::ptrdiff_t>(depths.size() / 100);
  const auto quantile = [&](std::ptrdiff_t rank) {
    std::nth_element(depths.begin(), depths.begin() + rank, depths.end());
    return depths[rank];
  };
  return {quantile(tail), quantile(static_cast<std::ptrdiff_t>(depths.size()) - 1 - tail)};
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
  const double num_priors = sum_over_pixels(normal.size(), [&](int x, int y) {
    return length2(load3<T>(prior, x, y)) > 0 ? 1.0 : 0.0;
  });
  if (num_priors == 0) return 0;
  const T tau = static_cast<T>(min_cosine), scale = weight / static_cast<T>(num_priors);
  const T along_axes = static_cast<T>(l1);
  const double sum = sum_over_pixels(normal.size(), [&](int x, int y) {
    const Vec3<T> target = load3<T>(prior, x, y), composited = load3<T>(normal, x, y);
    if (!(length2(target) > 0)) return 0.0;
    const T factor = pixel_weight.empty() ? T(1) : static_cast<T>(pixel_weight.at(x, y));
    const Vec3<T> unit = unit_normal(composited);
    Vec3<T> dL_dunit{}, gradient = load3<T>(dL_dnormal, x, y);
    gated_normal_loss_vjp(unit, target, tau, along_axes, scale * factor, dL_dunit);
    unit_normal_vjp(composited, dL_dunit, gradient);
    store3(dL_dnormal, x, y, gradient);
    return static_cast<double>(factor * gated_normal_loss(unit, target, tau, along_axes));
  });
  return sum / num_priors;
}

Image inverse_depth_weight(const Image& depth) {
  const auto [near, far] = central_range(depth);
  Image weights(depth.width(), depth.height(), 1);
  for (std::size_t i = 0; i < depth.num_pixels(); ++i) {
    const float z = depth.data()[i];
    if (!(z > 0)) continue;
    weights.data()[i] = far > near ? 1 - std::clamp((z - near) / (far - near), 0.0f, 1.0f) : 1.0f;
  }
  return weights;
}

template double NormalPriorLoss::evaluate(const Image&, const Image&, const Image&, float, Image&)
    const;
template double NormalPriorLoss::
    evaluate(const BasicImage<double>&, const Image&, const Image&, double, BasicImage<double>&)
        const;

}  // namespace glint
