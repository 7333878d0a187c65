// SPDX-License-Identifier: MIT
#include "metrics/depth.h"

#include <cmath>
#include <vector>

#include "metrics/reduce.h"

namespace glint {
namespace {

bool has_depth(float z, const DepthProtocol& protocol) {
  const double depth = static_cast<double>(z);
  return std::isfinite(z) && depth > protocol.min_depth &&
         (protocol.max_depth <= 0 || depth < protocol.max_depth);
}

// Calls f(prediction, reference) in double where both maps have a depth, in the order of the
// pixels.
template <class F>
void for_each_pair(
    ImageView prediction, ImageView reference, MaskView mask, const DepthProtocol& protocol, F&& f
) {
  for (int y = 0; y < reference.height; ++y)
    for (int x = 0; x < reference.width; ++x) {
      const float p = prediction.at(x, y), r = reference.at(x, y);
      if (counts(mask, x, y) && has_depth(p, protocol) && has_depth(r, protocol))
        f(static_cast<double>(p), static_cast<double>(r));
    }
}

DepthFit least_squares_scale(const std::vector<double>& p, const std::vector<double>& r) {
  double pr = 0, pp = 0;
  for (std::size_t i = 0; i < p.size(); ++i) pr += p[i] * r[i], pp += p[i] * p[i];
  return {pr / pp, 0};
}

// Centred sums: the plain normal equations cancel when depths vary little.
DepthFit least_squares_affine(const std::vector<double>& p, const std::vector<double>& r) {
  const double n = static_cast<double>(p.size());
  double mean_p = 0, mean_r = 0, covariance = 0, variance = 0;
  for (std::size_t i = 0; i < p.size(); ++i) mean_p += p[i] / n, mean_r += r[i] / n;
  for (std::size_t i = 0; i < p.size(); ++i) {
    covariance += (p[i] - mean_p) * (r[i] - mean_r);
    variance += (p[i] - mean_p) * (p[i] - mean_p);
  }
  const double scale = variance > 0 ? covariance / variance : 0;
  return {scale, mean_r - scale * mean_p};
}

struct DepthSums {
  double relative = 0, squares = 0, reference = 0;
  std::size_t close = 0, predicted = 0, scored = 0, valid = 0;

  DepthSums& operator+=(const DepthSums& other) {
    relative += other.relative, squares += other.squares, reference += other.reference;
    close += other.close, predicted += other.predicted;
    scored += other.scored, valid += other.valid;
    return *this;
  }
};

void add_pixel(
    float prediction, double r, const DepthProtocol& protocol, const DepthFit& fit, DepthSums& sums
) {
  const bool predicted = has_depth(prediction, protocol);
  ++sums.valid;
  sums.predicted += predicted;
  if (!predicted && !protocol.missing_counts) return;
  const double p = predicted ? fit.scale * static_cast<double>(prediction) + fit.shift : 0;
  const double error = p - r;
  ++sums.scored;
  sums.reference += r;
  sums.relative += std::abs(error) / r;
  sums.squares += error * error;
  sums.close += p > 0 && std::max(p / r, r / p) < protocol.delta_threshold;
}

}  // namespace

DepthProtocol release_depth_protocol() {
  DepthProtocol protocol;
  protocol.alignment = DepthAlignment::kMedian;
  protocol.missing_counts = false;
  protocol.max_depth = 20;
  protocol.rmse_over_mean_depth = true;
  return protocol;
}

DepthFit fit_depth(
    ImageView prediction, ImageView reference, MaskView mask, const DepthProtocol& protocol
) {
  check_maps(prediction, reference, mask, 1);
  if (protocol.alignment == DepthAlignment::kNone) return {};
  std::vector<double> p, r;
  for_each_pair(prediction, reference, mask, protocol, [&](double predicted, double truth) {
    p.push_back(predicted), r.push_back(truth);
  });
  if (p.empty()) return {};
  if (protocol.alignment == DepthAlignment::kScale) return least_squares_scale(p, r);
  if (protocol.alignment == DepthAlignment::kAffine) return least_squares_affine(p, r);
  return {median(r) / median(p), 0};
}

std::optional<DepthErrors> depth_errors(
    ImageView prediction,
    ImageView reference,
    MaskView mask,
    const DepthProtocol& protocol,
    const DepthFit& fit
) {
  check_maps(prediction, reference, mask, 1);
  const DepthSums sums = sum_rows<DepthSums>(reference.height, [&](int y) {
    DepthSums row;
    for (int x = 0; x < reference.width; ++x)
      if (const float r = reference.at(x, y); counts(mask, x, y) && has_depth(r, protocol))
        add_pixel(prediction.at(x, y), static_cast<double>(r), protocol, fit, row);
    return row;
  });
  if (sums.scored == 0) return std::nullopt;
  const double n = static_cast<double>(sums.scored);
  DepthErrors errors;
  errors.absrel = sums.relative / n;
  errors.rmse = std::sqrt(sums.squares / n);
  if (protocol.rmse_over_mean_depth) errors.rmse /= sums.reference / n;
  errors.delta1 = 100 * static_cast<double>(sums.close) / n;
  errors.coverage = 100 * static_cast<double>(sums.predicted) / static_cast<double>(sums.valid);
  errors.num_pixels = sums.scored;
  errors.fit = fit;
  return errors;
}

std::optional<DepthErrors> depth_errors(
    ImageView prediction, ImageView reference, MaskView mask, const DepthProtocol& protocol
) {
  const DepthFit fit = fit_depth(prediction, reference, mask, protocol);
  return depth_errors(prediction, reference, mask, protocol, fit);
}

}  // namespace glint
