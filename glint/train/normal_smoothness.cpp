// SPDX-License-Identifier: MIT
#include "glint/train/normal_smoothness.h"

#include "glint/train/pixel_sums.h"

namespace glint {

namespace {

template <class T>
BasicImage<T> unit_normals(const BasicImage<T>& normal) {
  BasicImage<T> units(normal.width(), normal.height(), 3);
  parallel_for(normal.num_pixels(), 1024, [&](std::size_t i) {
    const T* n = normal.data() + 3 * i;
    const Vec3<T> unit = unit_normal(Vec3<T>{n[0], n[1], n[2]});
    for (int c = 0; c < 3; ++c) units.data()[3 * i + c] = unit[c];
  });
  return units;
}

}  // namespace

template <class T>
double NormalSmoothnessLoss::evaluate(
    const BasicImage<T>& normal, const Image& image, T weight, BasicImage<T>& dL_dnormal
) const {
  check_fits("image of the normal smoothness", image, normal.size(), 3);
  const BasicImage<T> units = unit_normals(normal);
  const auto exists = [](const T* n) { return n[0] != 0 || n[1] != 0 || n[2] != 0; };
  const auto num_pixels = static_cast<double>(normal.num_pixels());
  const T sharpness = static_cast<T>(edge_sharpness), scale = weight / static_cast<T>(num_pixels);
  const double sum = sum_over_pixels(normal.size(), [&](int x, int y) {
    const auto here = edge_aware_smoothness_at<3>(units, image, sharpness, exists, x, y);
    const Vec3<T> dL_dunit{here.gradient[0], here.gradient[1], here.gradient[2]};
    Vec3<T> gradient = load3<T>(dL_dnormal, x, y);
    unit_normal_vjp(load3<T>(normal, x, y), scale * dL_dunit, gradient);
    store3(dL_dnormal, x, y, gradient);
    return here.loss;
  });
  return sum / num_pixels;
}

template double NormalSmoothnessLoss::evaluate(const Image&, const Image&, float, Image&) const;
template double
NormalSmoothnessLoss::evaluate(const BasicImage<double>&, const Image&, double, BasicImage<double>&)
    const;

}  // namespace glint
