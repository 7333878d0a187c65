// SPDX-License-Identifier: MIT
// Points as a search structure (nanoflann).
#pragma once

#include <limits>
#include <memory>
#include <span>

#include "metrics/mesh/triangle_tree.h"

namespace glint {

class PointTree {
 public:
  // At least one point; they outlive the tree.
  explicit PointTree(std::span<const Vec3f> points);
  ~PointTree();
  PointTree(const PointTree&) = delete;
  PointTree& operator=(const PointTree&) = delete;

  // As TriangleTree::nearest(); of several points as near, always the same one.
  Nearest nearest(
      Vec3f point,
      double max_distance = std::numeric_limits<double>::infinity(),
      std::int32_t guess = -1
  ) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glint
