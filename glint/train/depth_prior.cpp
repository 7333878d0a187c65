// SPDX-License-Identifier: MIT
#include "glint/train/depth_prior.h"

#include "glint/core/kernel.h"
#include "glint/train/check_fits.h"
#include "glint/train/depth_prior_kernels.h"
#include "glint/train/share_kernels.h"

namespace glint {

namespace {

template <class T>
DepthPairs<T> pairs_of(const BasicImage<T>& depth, const Image& prior, const Image& pixel_weight) {
  return {depth.on_device(), prior.on_device(), pixel_weight.on_device()};
}

template <class T>
void find_fit(const DepthPairs<T>& pairs, Array<DepthPriorFit>& fit) {
  Array<DepthMoments> moments;
  sum_kernel_to(pairs.depth.size(), DepthMomentsAt<T>{pairs}, moments);
  fit.resize(1);
  run_kernel(1, 1, FitDepthPrior{moments.on_device(), fit.on_device()});
}

// The gradient-matching term and its gradient with respect to the residuals, and from there to w.
template <class T>
struct GradientMatching {
  double loss = 0;
  BasicImage<T> dL_dresidual;  // [H][W][1], empty without the term
  Array<double> dL_dscale;     // [1] or empty
};

template <class T>
GradientMatching<T> match_gradients(const FittedPairs<T>& fitted, const DepthPriorLoss& options) {
  GradientMatching<T> result;
  if (options.gradient_scales <= 0) return result;
  const ImageSize size = fitted.pairs.depth.size();
  result.dL_dresidual = BasicImage<T>(size.width, size.height, 1);
  Array<double> count, scale;
  for (int s = 0, stride = 1; s < options.gradient_scales; ++s, stride *= 2) {
    const ImageSize grid{(size.width + stride - 1) / stride, (size.height + stride - 1) / stride};
    sum_kernel_to(grid, StridedWeight<T>{fitted.pairs, stride}, count);
    share_of(count.on_device(), static_cast<double>(options.gradient_weight), scale);
    const MatchGradients<T> match{
        fitted, stride, scale.on_device(), result.dL_dresidual.on_device()};
    const double sum = sum_kernel(grid, match);
    result.loss += told(scale) * sum;
  }
  sum_kernel_to(
      size, MatchingScaleVjp<T>{fitted.pairs, result.dL_dresidual.on_device()}, result.dL_dscale
  );
  return result;
}

}  // namespace

template <class T>
DepthPriorFit fit_depth_prior(
    const BasicImage<T>& depth, const Image& prior, const Image& pixel_weight
) {
  Array<DepthPriorFit> fit;
  find_fit(pairs_of(depth, prior, pixel_weight), fit);
  return fit[0];
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
  const DepthPairs<T> pairs = pairs_of(depth, prior, pixel_weight);
  Array<DepthPriorFit> fit;
  find_fit(pairs, fit);
  const FittedPairs<T> fitted{pairs, fit.on_device()};
  const GradientMatching<T> matching = match_gradients(fitted, *this);
  const DepthPriorAt<T> loss_at{
      fitted,
      matching.dL_dresidual.on_device(),
      matching.dL_dscale.on_device(),
      weight,
      dL_ddepth.on_device()};
  const double sum = sum_kernel(depth.size(), loss_at);
  if (SilentStep::now()) return unknown<double>();
  const DepthPriorFit found = fit[0];
  return found.valid ? sum / found.weight_sum + matching.loss : 0;
}

template DepthPriorFit fit_depth_prior(const Image&, const Image&, const Image&);
template DepthPriorFit fit_depth_prior(const BasicImage<double>&, const Image&, const Image&);
template double DepthPriorLoss::evaluate(const Image&, const Image&, const Image&, float, Image&)
    const;
template double DepthPriorLoss::
    evaluate(const BasicImage<double>&, const Image&, const Image&, double, BasicImage<double>&)
        const;

}  // namespace glint
