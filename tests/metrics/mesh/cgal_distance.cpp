// SPDX-License-Identifier: MIT
#include "tests/metrics/mesh/cgal_distance.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <cmath>

namespace glint::test {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 to_cgal(Vec3f v) {
  const Vec3d point = cast<double>(v);
  return {point.x, point.y, point.z};
}

}  // namespace

std::vector<double> cgal_distances(const TriangleMesh& mesh, std::span<const Vec3f> points) {
  Triangles triangles;
  const auto corner = [&](std::int32_t id) {
    return to_cgal(mesh.vertices[static_cast<std::size_t>(id)]);
  };
  for (const Triangle& face : mesh.faces)
    triangles.emplace_back(corner(face[0]), corner(face[1]), corner(face[2]));
  Tree tree(triangles.cbegin(), triangles.cend());
  tree.accelerate_distance_queries();
  std::vector<double> distances;
  for (const Vec3f point : points)
    distances.push_back(std::sqrt(tree.squared_distance(to_cgal(point))));
  return distances;
}

}  // namespace glint::test
