// SPDX-License-Identifier: MIT
#include "glint/train/plane_consistency.h"

#include <algorithm>

#include "glint/core/kernel.h"
#include "glint/train/check_fits.h"
#include "glint/train/normal_kernels.h"

namespace glint {

namespace {

constexpr std::size_t kPixelGrain = 1024;  // pixels a block

// The larger of both central differences.
float photo_difference(const Image& rgb, int x, int y) {
  const Vec3f along_x = load3<float>(rgb.view(), x + 1, y) - load3<float>(rgb.view(), x - 1, y);
  const Vec3f along_y = load3<float>(rgb.view(), x, y + 1) - load3<float>(rgb.view(), x, y - 1);
  return std::max(l1_norm(along_x), l1_norm(along_y)) / 3;
}

}  // namespace

Image flatness_weight(const Image& rgb) {
  Image weight(rgb.width(), rgb.height(), 1);
  float least = 1, most = 0;
  const auto inside = [&](auto&& f) {
    for (int y = 1; y + 1 < rgb.height(); ++y)
      for (int x = 1; x + 1 < rgb.width(); ++x) f(x, y, weight.at(x, y));
  };
  inside([&](int x, int y, float& difference) {
    difference = photo_difference(rgb, x, y);
    least = std::min(least, difference);
    most = std::max(most, difference);
  });
  const float scale = most > least ? 1 / (most - least) : 0.0f;
  inside([&](int, int, float& w) { w = square(1 - scale * (w - least)); });
  return weight;
}

double PlaneConsistencyLoss::evaluate(
    const Camera& camera,
    const Image& normal,
    const Image& depth,
    const Image& alpha,
    const Image& flatness,
    float weight,
    Image& dL_dnormal,
    Image& dL_ddepth
) {
  check_fits("flatness of the photo", flatness, depth.size(), 1);
  const Unprojector unproject = unprojector(camera, depth);
  const auto num_pixels = static_cast<double>(depth.num_pixels());
  fit(dL_dx_, depth.size(), 3);
  fit(dL_dy_, depth.size(), 3);
  const PlaneConsistencyAt loss_at{
      unproject,
      normal,
      alpha,
      flatness,
      weight / static_cast<float>(depth.num_pixels()),
      dL_dnormal.ref(),
      dL_dx_.ref(),
      dL_dy_.ref()};
  const double loss = sum_kernel(depth.size(), loss_at) / num_pixels;
  run_kernel(
      depth.num_pixels(),
      kPixelGrain,
      ConsistencyDepthVjp{unproject, dL_dx_.view(), dL_dy_.view(), dL_ddepth.ref()}
  );
  return loss;
}

}  // namespace glint
