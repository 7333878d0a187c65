// SPDX-License-Identifier: MIT
// Distances to a mesh by CGAL's AABB tree: what our own are compared with. Tests alone use CGAL,
// whose AABB tree is under the GPL, and one file alone includes it, since it compiles slowly.
#pragma once

#include <span>
#include <vector>

#include "glint/core/triangle_mesh.h"

namespace glint::test {

std::vector<double> cgal_distances(const TriangleMesh& mesh, std::span<const Vec3f> points);

}  // namespace glint::test
