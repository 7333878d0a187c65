// SPDX-License-Identifier: MIT
#include "glint/train/depth_prior.h"

#include "glint/train/pixel_sums.h"

namespace glint {

namespace {

// A relative variance of the depths below this is rounding of float, and no slope can be fitted.
constexpr double kConstantDepth = 1e-12;

// The pixels that count.
template <class T>
struct DepthPairs {
  const BasicImage<T>& depth;
  const Image& prior;
  const Image& pixel_weight;
  T z(int x, int y) const { return depth.at(x, y); }
  T target(int x, int y) const { return static_cast<T>(prior.at(x, y)); }
  // m, 0 where not valid.
  T weight(int x, int y) const {
    if (!(z(x, y) > 0) || !(prior.at(x, y) > 0)) return 0;
    return pixel_weight.empty() ? T(1) : static_cast<T>(pixel_weight.at(x, y));
  }
};

struct Moments {
  double pixels = 0, m = 0, z = 0, p = 0, zz = 0, zp = 0;
  Moments& operator+=(const Moments& o) {
    pixels += o.pixels, m += o.m, z += o.z, p += o.p, zz += o.zz, zp += o.zp;
    return *this;
  }
};
template <class T>
Moments moments_at(const DepthPairs<T>& pairs, int x, int y) {
  const auto m = static_cast<double>(pairs.weight(x, y));
  if (!(m > 0)) return {};
  const auto z = static_cast<double>(pairs.z(x, y)), p = static_cast<double>(pairs.target(x, y));
  return {1, m, m * z, m * p, m * z * z, m * z * p};
}

DepthFit fit_of(const Moments& sum) {
  DepthFit fit;
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
struct FittedPairs : DepthPairs<T> {
  DepthFit fit;
  T scale = static_cast<T>(fit.scale), shift = static_cast<T>(fit.shift);
  T residual(int x, int y) const { return scale * this->z(x, y) + shift - this->target(x, y); }
  // dw/dz without the factor m.
  T dscale_dz(int x, int y) const {
    const T prior_offset = this->target(x, y) - static_cast<T>(fit.mean_prior);
    const T depth_offset = this->z(x, y) - static_cast<T>(fit.mean_depth);
    return (prior_offset - 2 * scale * depth_offset) / static_cast<T>(fit.depth_variation);
  }
};

// The gradient-matching term and its gradient with respect to the residuals, and from there to w.
template <class T>
struct GradientMatching {
  double loss = 0;
  BasicImage<T> dL_dresidual;  // [H][W][1], empty without the term
  T dL_dscale = 0;
  T dL_dresidual_at(int x, int y) const {
    return dL_dresidual.empty() ? T(0) : dL_dresidual.at(x, y);
  }
};

// Sum of m m' |r' - r| over the pixel's forward differences; adds scale * its gradient.
template <class T>
double match_pixel(
    const FittedPairs<T>& pairs, int x, int y, int stride, T scale, BasicImage<T>& dL_dresidual
) {
  const T m = pairs.weight(x, y);
  if (!(m > 0)) return 0;
  double loss = 0;
  const auto add_difference = [&](int nx, int ny, bool is_forward) {
    if (nx < 0 || ny < 0 || nx >= pairs.depth.width() || ny >= pairs.depth.height()) return;
    const T pair_weight = m * pairs.weight(nx, ny);
    if (!(pair_weight > 0)) return;
    const T difference = pairs.residual(x, y) - pairs.residual(nx, ny);
    dL_dresidual.at(x, y) += scale * pair_weight * sign_of(difference);
    if (is_forward) loss += static_cast<double>(pair_weight * abs_of(difference));
  };
  add_difference(x + stride, y, true);
  add_difference(x, y + stride, true);
  add_difference(x - stride, y, false);
  add_difference(x, y - stride, false);
  return loss;
}

template <class T>
GradientMatching<T> match_gradients(const FittedPairs<T>& pairs, const DepthPriorLoss& options) {
  GradientMatching<T> result;
  if (options.gradient_scales <= 0) return result;
  const int width = pairs.depth.width(), height = pairs.depth.height();
  result.dL_dresidual = BasicImage<T>(width, height, 1);
  for (int s = 0, stride = 1; s < options.gradient_scales; ++s, stride *= 2) {
    const ImageSize grid{(width + stride - 1) / stride, (height + stride - 1) / stride};
    const double count = sum_over_pixels(grid, [&](int i, int j) {
      return static_cast<double>(pairs.weight(i * stride, j * stride));
    });
    if (!(count > 0)) continue;
    const double scale = static_cast<double>(options.gradient_weight) / count;
    result.loss +=
        scale * sum_over_pixels(grid, [&](int i, int j) {
          return match_pixel(
              pairs, i * stride, j * stride, stride, static_cast<T>(scale), result.dL_dresidual
          );
        });
  }
  result.dL_dscale = static_cast<T>(sum_over_pixels(pairs.depth.size(), [&](int x, int y) {
    return static_cast<double>(result.dL_dresidual.at(x, y) * pairs.z(x, y));
  }));
  return result;
}

}  // namespace

template <class T>
DepthFit fit_depth(const BasicImage<T>& depth, const Image& prior, const Image& pixel_weight) {
  const DepthPairs<T> pairs{depth, prior, pixel_weight};
  return fit_of(sum_over_pixels(depth.size(), [&](int x, int y) { return moments_at(pairs, x, y); })
  );
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
  const DepthFit fit = fit_depth(depth, prior, pixel_weight);
  if (!fit.valid) return 0;
  const FittedPairs<T> pairs{{depth, prior, pixel_weight}, fit};
  const GradientMatching<T> matching = match_gradients(pairs, *this);
  const T per_weight = static_cast<T>(1 / fit.weight_sum);
  const double squares = sum_over_pixels(depth.size(), [&](int x, int y) {
    const T m = pairs.weight(x, y);
    if (!(m > 0)) return 0.0;
    const T residual = pairs.residual(x, y);
    const T dL_dresidual = 2 * per_weight * m * residual + matching.dL_dresidual_at(x, y);
    const T through_scale = matching.dL_dscale * m * pairs.dscale_dz(x, y);
    dL_ddepth.at(x, y) += weight * (pairs.scale * dL_dresidual + through_scale);
    return static_cast<double>(m * residual * residual);
  });
  return squares / fit.weight_sum + matching.loss;
}

template DepthFit fit_depth(const Image&, const Image&, const Image&);
template DepthFit fit_depth(const BasicImage<double>&, const Image&, const Image&);
template double DepthPriorLoss::evaluate(const Image&, const Image&, const Image&, float, Image&)
    const;
template double DepthPriorLoss::
    evaluate(const BasicImage<double>&, const Image&, const Image&, double, BasicImage<double>&)
        const;

}  // namespace glint
