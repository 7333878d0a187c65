// SPDX-License-Identifier: MIT
// Which training views look at the same things [Chen24]: near ones that look the same way.
#pragma once

#include <cstddef>
#include <vector>

#include "glint/scene/scene.h"

namespace glint {

struct NeighborConfig {
  int count = 8;
  float max_angle_deg = 30;  // between the optical axes
  // Published: scene units of object captures, whose cameras spread over about two of them.
  float min_distance = 0.01f, max_distance = 1.5f;  // between the camera centres, published units
  float unit = 0.5f;                                // one published unit, of Scene::spatial_scale

  template <class V>
  void visit(V&& v) {
    v("neighbors", count, "neighbouring views of a view, at most");
    v("neighbor_max_angle", max_angle_deg, "degrees between the axes of neighbouring views");
    v("neighbor_min_distance", min_distance, "between neighbouring views, published scene units");
    v("neighbor_max_distance", max_distance, "between neighbouring views, published scene units");
    v("scene_unit", unit, "a published scene unit, of the scene's extent");
  }
};

// For each view the indices of its neighbours, nearest first (ties by index). unit: metres that a
// published scene unit stands for.
std::vector<std::vector<std::size_t>> neighbor_views(
    const std::vector<View>& views, const NeighborConfig& config, double unit
);

}  // namespace glint
