// SPDX-License-Identifier: MIT
#include "metrics/mesh/point_tree.h"

#include <cmath>

#include "glint/core/kd_tree.h"

namespace glint {
struct PointTree::Impl {
  explicit Impl(std::span<const Vec3f> points) : adaptor{points}, tree(3, adaptor) {}
  PointsAdaptor adaptor;
  KdTree tree;
};

PointTree::PointTree(std::span<const Vec3f> points) : impl_(std::make_unique<Impl>(points)) {}
PointTree::~PointTree() = default;

Nearest PointTree::nearest(Vec3f point, double max_distance, std::int32_t) const {
  const Vec3d query = cast<double>(point);
  const double coordinates[3] = {query.x, query.y, query.z};
  std::uint32_t id = 0;
  double distance2 = 0;
  impl_->tree.knnSearch(coordinates, 1, &id, &distance2);
  const double distance = std::sqrt(distance2);
  if (distance >= max_distance) return {max_distance, -1};
  return {distance, static_cast<std::int32_t>(id)};
}

}  // namespace glint
