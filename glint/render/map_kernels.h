// SPDX-License-Identifier: MIT
// Loops over the pixels of maps that a step takes between its ops.
#pragma once

#include "glint/core/image.h"
#include "glint/core/kernel.h"
#include "glint/render/blend.h"
#include "glint/render/depth_normal.h"
#include "glint/render/pinhole.h"
#include "glint/render/plane_depth.h"

namespace glint {

struct ExpectedDepth {
  const float *depth_sum, *alpha;
  float* depth;
  GLINT_HD void operator()(std::size_t i) const {
    depth[i] = expected_depth(depth_sum[i], alpha[i]);
  }
};
struct ExpectedDepthVjp {
  const float *depth_sum, *alpha, *dL_ddepth;
  float *dL_ddepth_sum, *dL_dalpha;  // added to
  GLINT_HD void operator()(std::size_t i) const {
    expected_depth_vjp(depth_sum[i], alpha[i], dL_ddepth[i], dL_ddepth_sum[i], dL_dalpha[i]);
  }
};

struct PlaneDepth {
  Pinhole<float> camera;
  ImageView distance, normal;  // [H][W][1] metres, [H][W][3], as composited
  ImageRef depth;
  GLINT_HD void operator()(std::size_t i) const {
    const int x = static_cast<int>(i) % depth.width, y = static_cast<int>(i) / depth.width;
    const Vec3f n = get3(normal.data, i);
    depth.data[i] = plane_depth(distance.data[i], n, camera.ray(x, y));
  }
};
struct PlaneDepthVjp {
  Pinhole<float> camera;
  ImageView distance, normal, dL_ddepth;
  float *dL_ddistance, *dL_dnormal;  // added to
  GLINT_HD void operator()(std::size_t i) const {
    const int x = static_cast<int>(i) % distance.width, y = static_cast<int>(i) / distance.width;
    const Vec3f n = get3(normal.data, i);
    Vec3f dL_dn = get3(dL_dnormal, i);
    plane_depth_vjp(
        distance.data[i], n, camera.ray(x, y), dL_ddepth.data[i], dL_ddistance[i], dL_dn
    );
    put3(dL_dnormal, i, dL_dn);
  }
};

// The first three channels.
struct CopyColor {
  const float* features;
  int channels;
  float* color;
  GLINT_HD void operator()(std::size_t i) const {
    for (std::size_t c = 0; c < 3; ++c)
      color[3 * i + c] = features[i * static_cast<std::size_t>(channels) + c];
  }
};

struct AddColor {
  const float* color;
  int channels;
  float* features;  // added to
  GLINT_HD void operator()(std::size_t i) const {
    for (std::size_t c = 0; c < 3; ++c)
      features[i * static_cast<std::size_t>(channels) + c] += color[3 * i + c];
  }
};

// Unit normals; zero where the composited one has no direction.
struct UnitNormals {
  const float* composited;
  float* unit;
  GLINT_HD void operator()(std::size_t i) const {
    const Vec3f n =
        unit_normal(Vec3f{composited[3 * i], composited[3 * i + 1], composited[3 * i + 2]});
    unit[3 * i] = n.x;
    unit[3 * i + 1] = n.y;
    unit[3 * i + 2] = n.z;
  }
};

// A depth a little behind, where there is one.
struct ShiftDepth {
  const float* depth;
  float shift;
  float* out;
  GLINT_HD void operator()(std::size_t i) const {
    out[i] = depth[i] + (depth[i] > 0 ? shift : 0.0f);
  }
};

struct SumPixels {
  ImageView map;  // one channel
  GLINT_HD double operator()(int x, int y) const { return static_cast<double>(map.at(x, y)); }
};

// How many of a run of values, laid out as rows of `across`, are NaN or infinite.
struct CountNotFinite {
  const float* values;
  std::size_t count;
  int across;
  GLINT_HD double operator()(int x, int y) const {
    const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(across) +
                          static_cast<std::size_t>(x);
    return i < count && !(values[i] - values[i] == 0) ? 1.0 : 0.0;
  }
};

// Camera rays moved on to a planar depth: the parameter of a ray with camera-space z = 1.
struct MoveAlongRays {
  const float *directions, *depth;
  float* origins;
  GLINT_HD void operator()(std::size_t i) const {
    for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) origins[k] += depth[i] * directions[k];
  }
};

using MapKernels = KernelList<
    ExpectedDepth,
    ExpectedDepthVjp,
    PlaneDepth,
    PlaneDepthVjp,
    CopyColor,
    AddColor,
    UnitNormals,
    ShiftDepth,
    SumPixels,
    CountNotFinite,
    MoveAlongRays>;

}  // namespace glint
