// SPDX-License-Identifier: MIT
// The surfaces that a straight ray meets one after the other: every pane, then the first opaque
// one. Beyond a mirror they are those that the mirrored ray meets, where they appear to stand.
#pragma once

#include <array>
#include <cstddef>

#include "datasets/glassroom/ray_scene.h"
#include "glint/scene/layer_maps.h"

namespace glint::path_tracing {

struct Layer {
  Vec3d position{}, normal{};  // world, unfolded; the shading normal, on the ray's side
  bool glass = false, mirror = false;
};

struct Layers {
  std::array<Layer, kMaxLayers> layers;
  std::size_t count = 0;
};

Layers layers_along(const RayScene& scene, Vec3f origin, Vec3f direction);

}  // namespace glint::path_tracing
