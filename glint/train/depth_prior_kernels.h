// SPDX-License-Identifier: MIT
// The depth prior (depth_prior.h), pixel by pixel.
#pragma once

#include "glint/core/kernel.h"
#include "glint/train/depth_prior.h"
#include "glint/train/pixel_access.h"

namespace glint {

// The pixels that count.
template <class T>
struct DepthPairs {
  BasicImageView<T> depth;
  ImageView prior, pixel_weight;  // pixel_weight may be empty
  GLINT_HD T z(int x, int y) const { return depth.at(x, y); }
  GLINT_HD T target(int x, int y) const { return static_cast<T>(prior.at(x, y)); }
  // m, 0 where not valid.
  GLINT_HD T weight(int x, int y) const {
    if (!(z(x, y) > 0) || !(prior.at(x, y) > 0)) return 0;
    return pixel_weight.empty() ? T(1) : static_cast<T>(pixel_weight.at(x, y));
  }
};

struct DepthMoments {
  double pixels = 0, m = 0, z = 0, p = 0, zz = 0, zp = 0;
  GLINT_HD DepthMoments& operator+=(const DepthMoments& o) {
    pixels += o.pixels, m += o.m, z += o.z, p += o.p, zz += o.zz, zp += o.zp;
    return *this;
  }
};
template <class T>
struct DepthMomentsAt {
  DepthPairs<T> pairs;
  GLINT_HD DepthMoments operator()(int x, int y) const {
    const auto m = static_cast<double>(pairs.weight(x, y));
    if (!(m > 0)) return {};
    const auto z = static_cast<double>(pairs.z(x, y)), p = static_cast<double>(pairs.target(x, y));
    return {1, m, m * z, m * p, m * z * z, m * z * p};
  }
};

// The least-squares fit of the prior, from its sums.
struct FitDepthPrior {
  // A relative variance of the depths below this is rounding of float: no slope can be fitted.
  static constexpr double kConstantDepth = 1e-12;
  const DepthMoments* moments;
  DepthPriorFit* fit;

  GLINT_HD void operator()(std::size_t) const { *fit = fit_of(*moments); }
  GLINT_HD static DepthPriorFit fit_of(const DepthMoments& sum) {
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
};

// With that fit, at the precision of T; where it is not valid, no pixel counts.
template <class T>
struct FittedPairs {
  DepthPairs<T> pairs;
  const DepthPriorFit* fit;

  GLINT_HD T scale() const { return static_cast<T>(fit->scale); }
  GLINT_HD T weight(int x, int y) const { return fit->valid ? pairs.weight(x, y) : T(0); }
  GLINT_HD T residual(int x, int y) const {
    return scale() * pairs.z(x, y) + static_cast<T>(fit->shift) - pairs.target(x, y);
  }
  // dw/dz without the factor m.
  GLINT_HD T dscale_dz(int x, int y) const {
    const T prior_offset = pairs.target(x, y) - static_cast<T>(fit->mean_prior);
    const T depth_offset = pairs.z(x, y) - static_cast<T>(fit->mean_depth);
    return (prior_offset - 2 * scale() * depth_offset) / static_cast<T>(fit->depth_variation);
  }
};

// Of the image that keeps every stride-th pixel.
template <class T>
struct StridedWeight {
  DepthPairs<T> pairs;
  int stride;
  GLINT_HD double operator()(int i, int j) const {
    return static_cast<double>(pairs.weight(i * stride, j * stride));
  }
};

// Sum of m m' |r' - r| over the pixel's forward differences; adds scale * its gradient.
template <class T>
struct MatchGradients {
  FittedPairs<T> fitted;
  int stride;
  const double* scale;
  BasicImageRef<T> dL_dresidual;

  GLINT_HD double operator()(int i, int j) const {
    const int x = i * stride, y = j * stride;
    if (!(fitted.weight(x, y) > 0)) return 0;
    const double right = difference(x, y, x + stride, y), down = difference(x, y, x, y + stride);
    difference(x, y, x - stride, y);  // these two count with that pixel
    difference(x, y, x, y - stride);
    return right + down;
  }

 private:
  // Of a pair; adds the gradient at (x, y).
  GLINT_HD double difference(int x, int y, int nx, int ny) const {
    const DepthPairs<T>& pairs = fitted.pairs;
    if (nx < 0 || ny < 0 || nx >= pairs.depth.width || ny >= pairs.depth.height) return 0;
    const T pair_weight = pairs.weight(x, y) * pairs.weight(nx, ny);
    if (!(pair_weight > 0)) return 0;
    const T difference = fitted.residual(x, y) - fitted.residual(nx, ny);
    dL_dresidual.at(x, y) += static_cast<T>(*scale) * pair_weight * sign_of(difference);
    return static_cast<double>(pair_weight * abs_of(difference));
  }
};

template <class T>
struct MatchingScaleVjp {
  DepthPairs<T> pairs;
  BasicImageView<T> dL_dresidual;
  GLINT_HD double operator()(int x, int y) const {
    return static_cast<double>(dL_dresidual.at(x, y) * pairs.z(x, y));
  }
};

template <class T>
struct DepthPriorAt {
  FittedPairs<T> fitted;
  BasicImageView<T> matching;    // dL/d(residual) of gradient matching, may be empty
  const double* matching_scale;  // and of the fit's scale; null: none
  T weight;
  BasicImageRef<T> dL_ddepth;

  GLINT_HD double operator()(int x, int y) const {
    const T m = fitted.weight(x, y);
    if (!(m > 0)) return 0.0;
    const T per_weight = static_cast<T>(1 / fitted.fit->weight_sum);
    const T residual = fitted.residual(x, y);
    const T matched = matching.empty() ? T(0) : matching.at(x, y);
    const T dL_dresidual = 2 * per_weight * m * residual + matched;
    const T dL_dscale = matching_scale == nullptr ? T(0) : static_cast<T>(*matching_scale);
    const T through_scale = dL_dscale * m * fitted.dscale_dz(x, y);
    dL_ddepth.at(x, y) += weight * (fitted.scale() * dL_dresidual + through_scale);
    return static_cast<double>(m * residual * residual);
  }
};

using DepthPriorKernels = KernelList<
    DepthMomentsAt<float>,
    FitDepthPrior,
    StridedWeight<float>,
    MatchGradients<float>,
    MatchingScaleVjp<float>,
    DepthPriorAt<float>>;

}  // namespace glint
