// SPDX-License-Identifier: MIT
#include "glint/train/normal_consistency.h"

#include <numeric>

#include "glint/core/parallel.h"
#include "glint/render/depth_normal.h"

namespace glint {

namespace {

constexpr std::size_t kRowGrain = 8;

// Back-projection with the rows' constants at hand.
struct Unprojector {
  const Image& depth;
  float fx, fy, cx, cy;
  Unprojector(const Camera& c, const Image& depth)
      : depth(depth),
        fx(static_cast<float>(1 / c.fx)),
        fy(static_cast<float>(1 / c.fy)),
        cx(static_cast<float>(c.cx)),
        cy(static_cast<float>(c.cy)) {}
  Vec3f ray(int x, int y) const {
    return {
        (static_cast<float>(x) + 0.5f - cx) * fx, (static_cast<float>(y) + 0.5f - cy) * fy, 1.0f};
  }
  Vec3f point(int x, int y) const { return depth.at(x, y) * ray(x, y); }
  bool valid(int x, int y) const { return depth.at(x, y) > 0; }
};

struct Differences {
  bool valid = false;
  Vec3f right_left{}, down_up{};
};
Differences differences_at(const Unprojector& p, int x, int y) {
  const bool inside = x > 0 && y > 0 && x + 1 < p.depth.width() && y + 1 < p.depth.height();
  if (!inside || !p.valid(x - 1, y) || !p.valid(x + 1, y) || !p.valid(x, y - 1) ||
      !p.valid(x, y + 1))
    return {};
  return {true, p.point(x + 1, y) - p.point(x - 1, y), p.point(x, y + 1) - p.point(x, y - 1)};
}

Vec3f load3(const Image& image, int x, int y) {
  const float* p = image.pixel(x, y);
  return {p[0], p[1], p[2]};
}
void add3(Image& image, int x, int y, Vec3f v) {
  float* p = image.pixel(x, y);
  p[0] += v.x, p[1] += v.y, p[2] += v.z;
}

}  // namespace

double NormalConsistencyLoss::evaluate(
    const Camera& camera,
    const Image& normal,
    const Image& depth,
    const Image& alpha,
    float weight,
    Image& dL_dnormal,
    Image& dL_ddepth
) {
  const int width = depth.width(), height = depth.height();
  const Unprojector unproject(camera, depth);
  const float scale = weight / static_cast<float>(depth.num_pixels());
  dL_dx_.assign(depth.num_pixels(), {});
  dL_dy_.assign(depth.num_pixels(), {});
  row_loss_.assign(height, 0.0);
  parallel_for(height, kRowGrain, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    double loss = 0;
    for (int x = 0; x < width; ++x) {
      const Differences d = differences_at(unproject, x, y);
      loss += 1;
      if (!d.valid) continue;
      const Vec3f n = load3(normal, x, y);
      const Vec3f target = alpha.at(x, y) * normal_from_differences(d.right_left, d.down_up);
      loss -= static_cast<double>(dot(n, target));
      add3(dL_dnormal, x, y, -scale * target);
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      normal_from_differences_vjp(
          d.right_left, d.down_up, (-scale * alpha.at(x, y)) * n, dL_dx_[i], dL_dy_[i]
      );
    }
    row_loss_[row] = loss;
  });
  // Each depth takes part in the differences of its four neighbours.
  parallel_for(height, kRowGrain, [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      Vec3f g{};
      if (x > 0) g += dL_dx_[i - 1];
      if (x + 1 < width) g += -dL_dx_[i + 1];
      if (y > 0) g += dL_dy_[i - width];
      if (y + 1 < height) g += -dL_dy_[i + width];
      dL_ddepth.at(x, y) += dot(g, unproject.ray(x, y));
    }
  });
  return std::accumulate(row_loss_.begin(), row_loss_.end(), 0.0) /
         static_cast<double>(depth.num_pixels());
}

Image NormalConsistencyLoss::depth_normals(const Camera& camera, const Image& depth) {
  Image normals(depth.width(), depth.height(), 3);
  const Unprojector unproject(camera, depth);
  for (int y = 0; y < depth.height(); ++y)
    for (int x = 0; x < depth.width(); ++x) {
      const Differences d = differences_at(unproject, x, y);
      if (d.valid) add3(normals, x, y, normal_from_differences(d.right_left, d.down_up));
    }
  return normals;
}

}  // namespace glint
