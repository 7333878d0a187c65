// SPDX-License-Identifier: MIT
// Nearest points (nanoflann).
#pragma once

#include <nanoflann.hpp>

#include <span>

#include "glint/core/vec.h"

namespace glint {

// How nanoflann sees points.
struct PointsAdaptor {
  std::span<const Vec3f> points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return static_cast<double>(points[i][static_cast<int>(axis)]);
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

// Constructed from (3, adaptor); adaptor and points outlive it. Queries are three doubles, answers
// ids and squared distances, nearest first.
using KdTree = nanoflann::
    KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointsAdaptor>, PointsAdaptor, 3>;

}  // namespace glint
