// SPDX-License-Identifier: MIT
#include "glint/train/plane_consistency.h"

#include <algorithm>

#include "glint/train/check_fits.h"
#include "glint/train/pixel_access.h"

namespace glint {

namespace {

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
  return loss_.evaluate(camera, normal, depth, alpha, flatness, weight, dL_dnormal, dL_ddepth);
}

}  // namespace glint
