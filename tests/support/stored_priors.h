// SPDX-License-Identifier: MIT
// Maps as other programs store them: normals in their axes, depth of their kind, noise.
#pragma once

#include <algorithm>
#include <cmath>

#include "datasets/prior_options.h"
#include "glint/core/rng.h"
#include "glint/scene/scene.h"

namespace glint::test {

// Unit camera normals, OpenCV axes, in `axes`; signed.
inline Image stored_normals(const Image& normal, PriorAxes axes, const Camera& camera) {
  Image stored = normal;
  for (std::size_t i = 0; i < normal.num_pixels(); ++i) {
    float* n = stored.data() + 3 * i;
    const Vec3d in_cam{n[0], n[1], n[2]};
    Vec3d out = in_cam;
    if (axes == PriorAxes::kOpengl) out = {in_cam.x, -in_cam.y, -in_cam.z};
    if (axes == PriorAxes::kStableNormal) out = {-in_cam.x, -in_cam.y, -in_cam.z};
    const auto& rows = camera.rotation_cam_from_world.rows;
    if (axes == PriorAxes::kWorld)
      out = in_cam.x * rows[0] + in_cam.y * rows[1] + in_cam.z * rows[2];
    for (int c = 0; c < 3; ++c) n[c] = static_cast<float>(out[c]);
  }
  return stored;
}

// (n + 1) / 2; zero normals become mid-grey.
inline Image encoded(Image normal) {
  for (float& value : normal.values()) value = 0.5f * value + 0.5f;
  return normal;
}

// Planar depth (0: nothing) to (0, 1], affine in depth or in 1 / depth.
inline Image stored_depth(Image depth, PriorDepth kind) {
  float nearest = 1e9f, farthest = 0;
  for (const float z : depth.values())
    if (z > 0) {
      nearest = std::min(nearest, z);
      farthest = std::max(farthest, z);
    }
  for (float& z : depth.values()) {
    if (!(z > 0)) continue;
    const float share = (z - nearest) / (farthest - nearest);
    if (kind == PriorDepth::kLinear)
      z = 0.05f + 0.9f * share;
    else if (kind == PriorDepth::kInverted)
      z = 0.95f - 0.9f * share;
    else
      z = 0.95f * nearest / z;
  }
  return depth;
}

inline Image noise_map(ImageSize size, int channels, std::uint64_t seed) {
  Rng rng(seed);
  Image map(size.width, size.height, channels);
  for (float& value : map.values()) value = rng.uniform();
  return map;
}

}  // namespace glint::test
