// SPDX-License-Identifier: MIT
// Losses on normal maps, pixel by pixel: prior (normal_prior.h), smoothness (normal_smoothness.h),
// consistency with the depth map (normal_consistency.h, plane_consistency.h).
#pragma once

#include <cstdint>
#include <cstring>

#include "glint/core/kernel.h"
#include "glint/core/sorted.h"
#include "glint/render/depth_normal.h"
#include "glint/scene/camera.h"
#include "glint/train/pixel_access.h"

namespace glint {

struct SumPriorWeights {
  ImageView prior, pixel_weight;  // pixel_weight may be empty: 1
  GLINT_HD double operator()(int x, int y) const {
    if (!(length2(load3<float>(prior, x, y)) > 0)) return 0.0;
    return pixel_weight.empty() ? 1.0 : static_cast<double>(pixel_weight.at(x, y));
  }
};

template <class T>
struct NormalPriorAt {
  BasicImageView<T> normal;
  ImageView prior, pixel_weight;  // pixel_weight may be empty
  T tau, along_axes;
  const T* scale;
  BasicImageRef<T> dL_dnormal;

  GLINT_HD double operator()(int x, int y) const {
    const Vec3<T> target = load3<T>(prior, x, y), composited = load3<T>(normal, x, y);
    if (!(length2(target) > 0)) return 0.0;
    const T factor = pixel_weight.empty() ? T(1) : static_cast<T>(pixel_weight.at(x, y));
    const Vec3<T> unit = unit_normal(composited);
    Vec3<T> dL_dunit{}, gradient{};
    gated_normal_loss_vjp(unit, target, tau, along_axes, *scale * factor, dL_dunit);
    unit_normal_vjp(composited, dL_dunit, gradient);
    add3(dL_dnormal, x, y, gradient);
    return static_cast<double>(factor * gated_normal_loss(unit, target, tau, along_axes));
  }
};

// The depths that 1 % of the pixels with depth fall short of and exceed; 0: there are none.
struct DepthRange {
  float near = 0, far = 0;
  GLINT_HD static std::size_t tail(std::size_t with_depth) { return with_depth / 100; }
};
// Depths as keys in their order; none: the largest.
inline constexpr std::uint32_t kNoDepth = ~0u;
struct DepthKeys {
  const float* depth;
  std::uint32_t* keys;
  GLINT_HD void operator()(std::size_t i) const {
    keys[i] = kNoDepth;
    if (depth[i] > 0) memcpy(&keys[i], &depth[i], sizeof(float));
  }
};
struct FindDepthRange {
  const std::uint32_t* sorted;
  std::size_t count;
  DepthRange* range;
  GLINT_HD void operator()(std::size_t) const {
    const std::size_t with_depth = first_at_least(sorted, count, kNoDepth);
    *range = {};
    if (with_depth == 0) return;
    const std::size_t tail = DepthRange::tail(with_depth);
    memcpy(&range->near, &sorted[tail], sizeof(float));
    memcpy(&range->far, &sorted[with_depth - 1 - tail], sizeof(float));
  }
};
struct WeighByDepth {
  const float* depth;
  const DepthRange* range;
  float* weights;
  GLINT_HD void operator()(std::size_t i) const {
    const float z = depth[i], near = range->near, far = range->far;
    const float share = min_of(max_of((z - near) / (far - near), 0.0f), 1.0f);
    weights[i] = !(z > 0) ? 0.0f : far > near ? 1 - share : 1.0f;
  }
};

// Unit normals of a composited map.
template <class T>
struct ReadUnitNormal {
  BasicImageView<T> normal;
  GLINT_HD bool operator()(int x, int y, T* out) const {
    const Vec3<T> unit = unit_normal(load3<T>(normal, x, y));
    out[0] = unit.x;
    out[1] = unit.y;
    out[2] = unit.z;
    return unit.x != 0 || unit.y != 0 || unit.z != 0;
  }
};
template <class T>
struct NormalSmoothnessAt {
  Smoothness<3, T, ReadUnitNormal<T>> smoothness;
  T scale;
  BasicImageRef<T> dL_dnormal;

  GLINT_HD double operator()(int x, int y) const {
    const auto here = smoothness.at(x, y);
    const Vec3<T> dL_dunit{here.gradient[0], here.gradient[1], here.gradient[2]};
    Vec3<T> gradient{};
    unit_normal_vjp(load3<T>(smoothness.read.normal, x, y), scale * dL_dunit, gradient);
    add3(dL_dnormal, x, y, gradient);
    return here.loss;
  }
};

// Back-projection of a depth map.
struct Unprojector {
  ImageView depth;
  float inverse_fx, inverse_fy, cx, cy;

  GLINT_HD Vec3f ray(int x, int y) const {
    return {
        (static_cast<float>(x) + 0.5f - cx) * inverse_fx,
        (static_cast<float>(y) + 0.5f - cy) * inverse_fy,
        1.0f};
  }
  GLINT_HD Vec3f point(int x, int y) const { return depth.at(x, y) * ray(x, y); }
  GLINT_HD bool valid(int x, int y) const { return depth.at(x, y) > 0; }
};
// depth: [H][W][1], where it is looked at.
inline Unprojector unprojector(const Camera& camera, ImageView depth) {
  return {
      depth,
      static_cast<float>(1 / camera.fx),
      static_cast<float>(1 / camera.fy),
      static_cast<float>(camera.cx),
      static_cast<float>(camera.cy)};
}
// Central differences of the points; not valid at the border and beside pixels without depth.
struct DepthDifferences {
  bool valid;
  Vec3f right_left, down_up;
};
GLINT_HD DepthDifferences differences_at(const Unprojector& p, int x, int y) {
  const bool inside = x > 0 && y > 0 && x + 1 < p.depth.width && y + 1 < p.depth.height;
  if (!inside || !p.valid(x - 1, y) || !p.valid(x + 1, y) || !p.valid(x, y - 1) ||
      !p.valid(x, y + 1))
    return {false, {}, {}};
  return {true, p.point(x + 1, y) - p.point(x - 1, y), p.point(x, y + 1) - p.point(x, y - 1)};
}

// kUnit: of N / |N|, else of N.
template <bool kUnit>
struct ConsistencyAt {
  Unprojector unproject;
  ImageView normal, alpha, pixel_weight;  // pixel_weight may be empty
  float scale;
  ImageRef dL_dnormal;
  ImageRef dL_dx, dL_dy;  // [H][W][3], written: gradients of the differences

  GLINT_HD double operator()(int x, int y) const {
    const DepthDifferences d = differences_at(unproject, x, y);
    const float factor = pixel_weight.empty() ? 1.0f : pixel_weight.at(x, y);
    const float share = scale * factor;
    Vec3f g_right_left{}, g_down_up{};
    double loss = 1;
    if (d.valid) {
      const Vec3f sum = load3<float>(normal, x, y);
      const Vec3f n = kUnit ? unit_normal(sum) : sum;
      const Vec3f target = alpha.at(x, y) * normal_from_differences(d.right_left, d.down_up);
      loss -= static_cast<double>(dot(n, target));
      Vec3f dL_dsum = -share * target;
      if constexpr (kUnit) {
        const Vec3f dL_dn = dL_dsum;
        dL_dsum = {};
        unit_normal_vjp(sum, dL_dn, dL_dsum);
      }
      add3(dL_dnormal, x, y, dL_dsum);
      normal_from_differences_vjp(
          d.right_left, d.down_up, (-share * alpha.at(x, y)) * n, g_right_left, g_down_up
      );
    }
    store3(dL_dx, x, y, g_right_left);
    store3(dL_dy, x, y, g_down_up);
    return static_cast<double>(factor) * loss;
  }
};
using NormalConsistencyAt = ConsistencyAt<false>;
using UnitNormalConsistencyAt = ConsistencyAt<true>;
// The weights of pixels that have a normal of the depth, so that the mean over all pixels is the
// weighted mean over these: their sum first, then each.
struct SumConsistentWeights {
  Unprojector unproject;
  ImageView pixel_weight;  // may be empty: 1

  GLINT_HD double at(int x, int y) const {
    if (!differences_at(unproject, x, y).valid) return 0;
    return pixel_weight.empty() ? 1.0 : static_cast<double>(pixel_weight.at(x, y));
  }
  GLINT_HD double operator()(int x, int y) const { return at(x, y); }
};
struct ShareConsistentWeights {
  SumConsistentWeights weights;
  const double* sum;
  ImageRef out;

  GLINT_HD void operator()(std::size_t i) const {
    const int x = static_cast<int>(i) % out.width, y = static_cast<int>(i) / out.width;
    const auto pixels = static_cast<double>(out.width) * static_cast<double>(out.height);
    out.at(x, y) = *sum > 0 ? static_cast<float>(weights.at(x, y) * pixels / *sum) : 0.0f;
  }
};
// W |A N_D - N|_1 (plane_consistency.h).
struct PlaneConsistencyAt {
  Unprojector unproject;
  ImageView normal, alpha, flatness;
  float scale;
  ImageRef dL_dnormal;
  ImageRef dL_dx, dL_dy;  // [H][W][3], written: gradients of the differences

  GLINT_HD double operator()(int x, int y) const {
    const DepthDifferences d = differences_at(unproject, x, y);
    Vec3f g_right_left{}, g_down_up{};
    float loss = 0;
    if (d.valid) {
      const float a = alpha.at(x, y), w = flatness.at(x, y);
      const Vec3f off =
          a * normal_from_differences(d.right_left, d.down_up) - load3<float>(normal, x, y);
      loss = w * l1_norm(off);
      const Vec3f slope = (scale * w) * Vec3f{sign_of(off.x), sign_of(off.y), sign_of(off.z)};
      add3(dL_dnormal, x, y, -slope);
      normal_from_differences_vjp(d.right_left, d.down_up, a * slope, g_right_left, g_down_up);
    }
    store3(dL_dx, x, y, g_right_left);
    store3(dL_dy, x, y, g_down_up);
    return static_cast<double>(loss);
  }
};
// Each depth takes part in the differences of its four neighbours.
struct ConsistencyDepthVjp {
  Unprojector unproject;
  ImageView dL_dx, dL_dy;
  ImageRef dL_ddepth;

  GLINT_HD void operator()(std::size_t i) const {
    const int width = dL_dx.width, height = dL_dx.height;
    const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
    Vec3f g{};
    if (x > 0) g += load3<float>(dL_dx, x - 1, y);
    if (x + 1 < width) g += -load3<float>(dL_dx, x + 1, y);
    if (y > 0) g += load3<float>(dL_dy, x, y - 1);
    if (y + 1 < height) g += -load3<float>(dL_dy, x, y + 1);
    dL_ddepth.at(x, y) += dot(g, unproject.ray(x, y));
  }
};

using NormalKernels = KernelList<
    ConsistencyDepthVjp,
    DepthKeys,
    FindDepthRange,
    WeighByDepth,
    SumPriorWeights,
    NormalPriorAt<float>,
    NormalSmoothnessAt<float>,
    ConsistencyAt<false>,
    ConsistencyAt<true>,
    SumConsistentWeights,
    ShareConsistentWeights,
    PlaneConsistencyAt>;

}  // namespace glint
