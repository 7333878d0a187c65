// SPDX-License-Identifier: MIT
#include "glint/train/depth_prior.h"

#include "glint/core/kernel.h"
#include "glint/train/check_fits.h"
#include "glint/train/depth_prior_kernels.h"

namespace glint {

namespace {

// A relative variance of the depths below this is rounding of float, and no slope can be fitted.
constexpr double kConstantDepth = 1e-12;

DepthPriorFit fit_of(const DepthMoments& sum) {
  DepthPriorFit fit;
  if (sum.pixels < 2) return fit;
  fit.weight_sum = sum.m;
  fit.mean_depth = sum.z / sum.m;
  fit.mean_prior = sum.p / sum.m;
  fit.depth_variation = sum.zz - sum.z * fit.mean_depth;
  if (!(fit.depth_variation > kConstantDepth * sum.zz)) return fit;
  fit.scale = (sum.zp - sum.z * fit.mean_prior) / fit.depth_variation;
  fit.shift = fit.mean_prior - fit.scale * fit.mean_depth;
  fit.valid = true;
  return fit;
}

template <class T>
FittedPairs<T> fitted_pairs(const DepthPairs<T>& pairs, const DepthPriorFit& fit) {
  return {
      pairs,
      static_cast<T>(fit.scale),
      static_cast<T>(fit.shift),
      static_cast<T>(fit.mean_depth),
      static_cast<T>(fit.mean_prior),
      static_cast<T>(fit.depth_variation)};
}

// The gradient-matching term and its gradient with respect to the residuals, and from there to w.
template <class T>
struct GradientMatching {
  double loss = 0;
  BasicImage<T> dL_dresidual;  // [H][W][1], empty without the term
  T dL_dscale = 0;
};

template <class T>
GradientMatching<T> match_gradients(const FittedPairs<T>& fitted, const DepthPriorLoss& options) {
  GradientMatching<T> result;
  if (options.gradient_scales <= 0) return result;
  const ImageSize size = fitted.pairs.depth.size();
  result.dL_dresidual = BasicImage<T>(size.width, size.height, 1);
  for (int s = 0, stride = 1; s < options.gradient_scales; ++s, stride *= 2) {
    const ImageSize grid{(size.width + stride - 1) / stride, (size.height + stride - 1) / stride};
    const double count = sum_kernel(grid, StridedWeight<T>{fitted.pairs, stride});
    if (!(count > 0)) continue;
    const double scale = static_cast<double>(options.gradient_weight) / count;
    const MatchGradients<T> match{fitted, stride, static_cast<T>(scale), result.dL_dresidual.ref()};
    result.loss += scale * sum_kernel(grid, match);
  }
  result.dL_dscale =
      static_cast<T>(sum_kernel(size, MatchingScaleVjp<T>{fitted.pairs, result.dL_dresidual.view()})
      );
  return result;
}

}  // namespace

template <class T>
DepthPriorFit fit_depth_prior(
    const BasicImage<T>& depth, const Image& prior, const Image& pixel_weight
) {
  const DepthPairs<T> pairs{depth, prior, pixel_weight};
  return fit_of(sum_kernel(depth.size(), DepthMomentsAt<T>{pairs}));
}

template <class T>
double DepthPriorLoss::evaluate(
    const BasicImage<T>& depth,
    const Image& prior,
    const Image& pixel_weight,
    T weight,
    BasicImage<T>& dL_ddepth
) const {
  if (prior.empty()) return 0;
  check_fits("depth prior", prior, depth.size(), 1);
  if (!pixel_weight.empty())
    check_fits("weights of the depth prior", pixel_weight, depth.size(), 1);
  const DepthPriorFit fit = fit_depth_prior(depth, prior, pixel_weight);
  if (!fit.valid) return 0;
  const FittedPairs<T> fitted = fitted_pairs<T>({depth, prior, pixel_weight}, fit);
  const GradientMatching<T> matching = match_gradients(fitted, *this);
  const DepthPriorAt<T> loss_at{
      fitted,
      matching.dL_dresidual.view(),
      matching.dL_dscale,
      static_cast<T>(1 / fit.weight_sum),
      weight,
      dL_ddepth.ref()};
  return sum_kernel(depth.size(), loss_at) / fit.weight_sum + matching.loss;
}

template DepthPriorFit fit_depth_prior(const Image&, const Image&, const Image&);
template DepthPriorFit fit_depth_prior(const BasicImage<double>&, const Image&, const Image&);
template double DepthPriorLoss::evaluate(const Image&, const Image&, const Image&, float, Image&)
    const;
template double DepthPriorLoss::
    evaluate(const BasicImage<double>&, const Image&, const Image&, double, BasicImage<double>&)
        const;

}  // namespace glint
