// SPDX-License-Identifier: MIT
// NearerSurface and the light between layers, pixel by pixel.
#pragma once

#include "glint/core/kernel.h"
#include "glint/render/blend.h"
#include "glint/render/depth_normal.h"
#include "glint/render/transport.h"

namespace glint {

// A set as it was rasterised, of so many features: [H][W][channels], [H][W][1] twice, [H][W][3].
struct SurfaceMaps {
  const float *features, *alpha, *depth_sum, *normal;
};
struct SurfaceMapRefs {
  float *features, *alpha, *depth_sum, *normal;

  GLINT_HD void copy(std::size_t i, int channels, const SurfaceMaps& from) const {
    const auto width = static_cast<std::size_t>(channels);
    for (std::size_t k = width * i; k < width * (i + 1); ++k) features[k] = from.features[k];
    alpha[i] = from.alpha[i];
    depth_sum[i] = from.depth_sum[i];
    for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) normal[k] = from.normal[k];
  }
  GLINT_HD void clear(std::size_t i, int channels) const {
    const auto width = static_cast<std::size_t>(channels);
    for (std::size_t k = width * i; k < width * (i + 1); ++k) features[k] = 0;
    alpha[i] = depth_sum[i] = 0;
    for (std::size_t k = 3 * i; k < 3 * i + 3; ++k) normal[k] = 0;
  }
  // Lets nothing through, and without a normal mirrors nothing.
  GLINT_HD void close(std::size_t i, int channels, int transparency) const {
    features[i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(transparency)] = 0;
    put3(normal, i, Vec3f{});
  }
};

// What the interface set has there counts where it is a pane, in front of what the other set has.
GLINT_HD bool is_nearer_pane(float transparency, float pane_depth, float other_depth) {
  return is_glass(transparency) && pane_depth > 0 && (other_depth <= 0 || pane_depth < other_depth);
}

struct PickNearer {
  int channels, transparency;  // features, and which of them is t
  SurfaceMaps panes, others;
  const float *other_depth, *light;  // [H][W][1] median, metres; 0: nobody looks
  SurfaceMapRefs out;
  float* is_pane;

  GLINT_HD void operator()(std::size_t i) const {
    const float t =
        panes.features
            [i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(transparency)];
    const float z = expected_depth(panes.depth_sum[i], panes.alpha[i]);
    const bool lit = light[i] > 0, pane = lit && is_nearer_pane(t, z, other_depth[i]);
    is_pane[i] = pane ? 1.0f : 0.0f;
    out.copy(i, channels, pane ? panes : others);
    if (!lit) out.close(i, channels, transparency);
  }
};
struct PickNearerVjp {
  int channels, transparency;
  const float *is_pane, *light;
  SurfaceMaps dL_dout;
  SurfaceMapRefs dL_dpanes, dL_dothers;

  GLINT_HD void operator()(std::size_t i) const {
    const bool pane = is_pane[i] > 0;
    (pane ? dL_dpanes : dL_dothers).copy(i, channels, dL_dout);
    (pane ? dL_dothers : dL_dpanes).clear(i, channels);
    if (!(light[i] > 0)) dL_dothers.close(i, channels, transparency);
  }
};

// What a layer lets pass of the light that gets to it, (1 - k_s) t; below `least`, none.
struct PassLight {
  const float *transparency, *mirrored, *light;  // light: null: all of it
  const float* known;                            // null or 0: looks for its surface
  float least;
  float* passed;
  GLINT_HD void operator()(std::size_t i) const {
    const float share = (1 - mirrored[i]) * transparency[i] * (light == nullptr ? 1.0f : light[i]);
    const bool looks = share >= least && (known == nullptr || known[i] <= 0);
    passed[i] = looks ? share : 0.0f;
  }
};

// Where the layer behind another one may begin, `gap` behind it, or at it where is_pane (null:
// nowhere) says so; `before` where that other one is not.
struct LimitBehind {
  const float *depth, *before;  // metres
  const float* is_pane;
  float gap;
  float* limit;
  GLINT_HD void operator()(std::size_t i) const {
    const bool at = is_pane != nullptr && is_pane[i] > 0;
    const float behind = depth[i] + (at ? 0.0f : gap);
    limit[i] = depth[i] > 0 && behind > before[i] ? behind : before[i];
  }
};

using NearerSurfaceKernels = KernelList<PickNearer, PickNearerVjp, PassLight, LimitBehind>;

}  // namespace glint
